// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/capture/camera_mode.h"

#include <algorithm>
#include <string_view>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {

CameraMode parse_camera_mode(const std::string& uri) {
  const auto fail = [&](std::string_view problem) {
    throw UserError(uri + ": " + std::string(problem) + "; a mode is like v4l2:0?size=1280x720&fps=30&format=MJPG");
  };
  const auto begin = uri.find(':') + 1, question = std::min(uri.find('?', begin), uri.size());
  CameraMode mode;
  mode.device = uri.substr(begin, question - begin);
  if (mode.device.empty()) fail("which camera is not said");
  for (std::size_t at = question + 1; at < uri.size();) {
    const std::size_t end = std::min(uri.find('&', at), uri.size());
    const std::string part = uri.substr(at, end - at);
    at = end + 1;
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string key = part.substr(0, equals), value = part.substr(std::min(equals + 1, part.size()));
    if (key == "size") {
      const std::size_t x = std::min(value.find('x'), value.size());
      const auto width = parse_integer(value.substr(0, x)),
                 height = parse_integer(value.substr(std::min(x + 1, value.size())));
      if (!width || !height || *width < 1 || *height < 1 || *width > 16384 || *height > 16384)
        fail("'" + value + "' is no size");
      mode.width_px = static_cast<int>(*width);
      mode.height_px = static_cast<int>(*height);
    } else if (key == "fps") {
      const auto rate = parse_double(value);
      if (!rate || *rate < 0.1 || *rate > 1000) fail("'" + value + "' is no rate");
      mode.rate_hz = *rate;
    } else if (key == "format") {
      if (value.size() != 4) fail("'" + value + "' is no format of four letters");
      mode.format = value;
    } else {
      fail("the key '" + key + "' is not known");
    }
  }
  return mode;
}

}  // namespace coslam
