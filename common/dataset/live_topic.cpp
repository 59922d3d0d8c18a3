// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/live_topic.h"

#include <algorithm>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {
namespace {

// DOMAIN of domain=DOMAIN.
std::string_view value_of(std::string_view setting, std::string_view key) {
  if (!setting.starts_with(key)) return {};
  setting.remove_prefix(key.size());
  return setting.starts_with('=') ? setting.substr(1) : std::string_view();
}

}  // namespace

LiveTopic live_topic(const std::string& name) {
  constexpr int kMostDomain = 232;
  std::string_view rest = std::string_view(name).substr(kRos2Scheme.size());
  const std::size_t mark = rest.find('?');
  LiveTopic out;
  out.topic = rest.substr(0, mark);
  if (out.topic.size() < 2 || !out.topic.starts_with('/') || out.topic.ends_with('/')) {
    throw UserError("'" + name + "' names no topic: ros2:/TOPIC is expected, with the whole name of the topic");
  }
  rest = mark == std::string_view::npos ? std::string_view() : rest.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view setting = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), setting.size() + 1));
    const auto domain = parse_integer(value_of(setting, "domain"));
    const std::string_view interface = value_of(setting, "interface");
    if (domain && *domain >= 0 && *domain <= kMostDomain) {
      out.domain = static_cast<int>(*domain);
    } else if (!interface.empty()) {
      out.interfaces = {std::string(interface)};
    } else {
      throw UserError("'" + name + "': '" + std::string(setting) +
                      "' is not known; after '?' there may be domain=N (0 to 232) and interface=ADDRESS, with '&' "
                      "between them");
    }
  }
  return out;
}

}  // namespace coslam
