// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/tools/sequence_argument.h"

#include <functional>
#include <string_view>

#include "common/scene/scene.h"
#include "deploy/tools/console.h"

namespace coslam {

Sequence sequence_argument(const std::string& text) {
  constexpr std::string_view kSimulated = "sim:";
  if (!text.starts_with(kSimulated)) return load_sequence(text);
  RenderOptions options;
  options.scene = text.substr(kSimulated.size());
  Progress progress("rendering " + options.scene);
  return load_sequence(cached_sequence(options, std::ref(progress)));
}

}  // namespace coslam
