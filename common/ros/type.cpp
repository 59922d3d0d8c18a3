// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/ros/type.h"

#include "common/ros/messages.h"

namespace coslam::ros {
namespace {

template <class... T>
std::vector<const TypeText*> texts_of(const std::tuple<T...>* /*types*/) {
  return {&type_text<T>()...};
}

}  // namespace

const TypeText* find_type(std::string_view name) {
  static const std::vector<const TypeText*> kTexts = texts_of(static_cast<const Messages*>(nullptr));
  const auto found =
      std::ranges::find(kTexts, name, [](const TypeText* text) -> std::string_view { return text->name; });
  return found == kTexts.end() ? nullptr : *found;
}

}  // namespace coslam::ros
