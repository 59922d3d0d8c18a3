// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/model/image_account.h"

namespace coslam {

std::string ImageAccount::losses() const {
  std::string text;
  for (std::size_t i = 0; i < kImageFates; ++i) {
    const auto fate = static_cast<ImageFate>(i);
    if (fate == ImageFate::kTracked || images[i] == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(images[i]) + " " + std::string(words_of(fate).after);
  }
  return text;
}

std::string losses_of(const std::string& agent, const ImageAccount& images) {
  return agent + ": of " + std::to_string(images.captured()) + " images " + images.losses();
}

ImageAccount& ImageAccount::operator+=(const ImageAccount& other) {
  for (std::size_t i = 0; i < kImageFates; ++i) images[i] += other.images[i];
  return *this;
}

}  // namespace coslam
