// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/last_images.h"

#include <utility>

namespace coslam {

LastImagesReport LastImages::run(KeyImageEdit& edit, PlaceRecognition& places) {
  std::erase_if(waiting_, [&](const auto& image) { return places.remember_last(edit, image.first, image.second); });
  return {};
}

}  // namespace coslam
