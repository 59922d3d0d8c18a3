// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/base/text.h"
#include "common/dataset/calibration_dialects.h"

namespace coslam::calibration {
namespace {

void set_basalt_lens(CameraModel& camera, const YamlValue& type, const YamlValue& v) {
  const std::string name = type.text();
  if (const auto found = lens_named(LensFile::kBasalt, name)) {
    const LensTraits& lens = lens_traits(found->model);
    std::vector<double> k;
    for (std::size_t i = 0; i < found->form.terms; ++i) k.push_back(v.at(std::string(lens.terms[i])).number());
    set_distortion(camera, v, std::string(lens.name()), k);
  } else if (name == "eucm") {
    set_eucm(camera, v, v.at("alpha").number(), v.at("beta").number());
  } else {
    auto names = lens_names(LensFile::kBasalt);
    names.emplace_back("eucm");
    type.fail("the camera type '" + name + "' is not supported, only " + listed(names) + " are");
  }
}

}  // namespace

// value0: lists of the lenses and of the sizes of its cameras, which have numbers for names.
CameraModel read_basalt(const YamlValue& root, const std::string& camera_name) {
  const auto lenses = root.at("value0").at("intrinsics").items(), sizes = root.at("value0").at("resolution").items();
  std::string names;
  for (std::size_t i = 0; i < lenses.size(); ++i) names += (i == 0 ? "" : ", ") + ("cam" + std::to_string(i));
  if (camera_name.empty() && lenses.size() > 1) root.fail(several_cameras(names));
  const std::string number =
      camera_name.empty() ? "0" : camera_name.substr(std::min<std::size_t>(3, camera_name.size()));
  const auto at = static_cast<std::size_t>(parse_integer(number).value_or(-1));
  if (at >= lenses.size() || at >= sizes.size() || (!camera_name.empty() && !camera_name.starts_with("cam")))
    root.fail("there is no camera '" + camera_name + "', of these there are: " + names);
  CameraModel camera;
  const auto size = sizes[at].items();
  if (size.size() != 2) sizes[at].fail("[width, height] is expected");
  camera.width_px = pixels(size[0]);
  camera.height_px = pixels(size[1]);
  const YamlValue v = lenses[at].at("intrinsics");
  camera.fx = v.at("fx").number();
  camera.fy = v.at("fy").number();
  camera.cx = v.at("cx").number();
  camera.cy = v.at("cy").number();
  set_basalt_lens(camera, lenses[at].at("camera_type"), v);
  return camera;
}

}  // namespace coslam::calibration
