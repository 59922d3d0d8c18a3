// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "common/model/track_frame.h"
#include "server/estimator/map/keys.h"
#include "server/estimator/pipeline/stage.h"
#include "server/estimator/places/place_recognition.h"

namespace coslam {

struct LastImagesReport {};

// Remembers the last image of an agent's run, once its frame is there, so that where a run ended is a known place too.
class LastImages {
 public:
  static constexpr std::string_view kName = "last_images";
  using Config = NoConfig<LastImages>;
  explicit LastImages(const Config& stage_config) : config(stage_config) {}
  Config config;

  // Takes the descriptors of the last image of an agent's run; its frame may come later.
  void take_last_image(CameraId camera, DescriptorReply reply) { waiting_.insert_or_assign(camera, std::move(reply)); }
  LastImagesReport run(KeyImageEdit& edit, PlaceRecognition& places);

 private:
  std::map<CameraId, DescriptorReply> waiting_;
};

}  // namespace coslam
