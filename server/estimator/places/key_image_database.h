// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/estimator/map/keys.h"
#include "server/estimator/map/rows.h"
#include "server/estimator/places/described_image.h"
#include "server/estimator/places/key_image.h"
#include "server/estimator/solve/appearance.h"

namespace coslam {

// Remembered image that shows a place which other key images show too.
struct LoopCandidate {
  const KeyImage* image = nullptr;
  std::map<TrackId, PointId> observed;  // points that the image observed itself
  PlaceMatch place;
};

// Points found near their prediction from a camera's pose: within the gate, or all of them shifted alike.
struct ExpectedPlace {
  std::vector<std::pair<TrackId, PointId>> in_place;
  std::optional<PlaceMatch> beside;
};

// Database of key images of all cameras, retrieved by appearance and verified by geometry.
class KeyImageDatabase {
 public:
  explicit KeyImageDatabase(const RecogniseConfig& config) : config_(config) {}

  // Remembers an image with its descriptors; nothing without any.
  void add(KeyImageEdit& edit, const DescribedImage& image, const DescriptorReply& reply);
  // Finds points of the newest key images of these cameras, not older than first_set, near where the camera's
  // pose predicts them: within gate_px, or farther off, where a drift of the map moved them. Empty when they are too
  // few.
  ExpectedPlace find_expected(const Map& map, const DescribedImage& image, const DescriptorReply& reply,
                              const std::vector<CameraId>& cameras, SetId first_set, double gate_px) const;
  // Returns the remembered images of one map, in the order in which they came.
  std::vector<const KeyImage*> images_of(const Map& map, MapId map_id) const;
  // Returns the maps that have remembered images.
  std::set<MapId> maps(const Map& map) const;
  // Finds the place that looks most like a remembered image, among the key images that may be asked: by the descriptors
  // of its features and the points behind these.
  std::optional<LoopCandidate> find_again(const Map& map, const KeyImage& image,
                                          const std::function<bool(const KeyImage&, MapId)>& may_ask) const;
  // Adds the key images of another database, as images of a map that was taken in.
  void take_in(const KeyImageDatabase& other, const Renumbered& renumbered);
  // Forgets key images.
  void forget(const std::vector<ImageKey>& views);
  // Memory of the key images and their index, in bytes.
  std::size_t bytes() const;
  // Writes the key images as rows that were not written before; and reads them, into an empty database.
  void save(std::vector<Row>* rows);
  void restore(const Tables& tables);
  // Finds the camera's pose by the place that looks most like its image, among the key images that may be asked; these
  // have a pose, in the map that is named.
  std::optional<PlaceMatch> find(const Map& map, const DescribedImage& image, const DescriptorReply& reply,
                                 const std::function<bool(const KeyImage&, MapId)>& may_ask) const;

 private:
  struct Asked {
    std::vector<const KeyImage*> images;  // most similar images, best first
    MapId in;
  };
  Asked asked_for(const Map& map, const std::vector<std::uint8_t>& descriptors,
                  const std::function<bool(const KeyImage&, MapId)>& may_ask) const;

  RecogniseConfig config_;
  AppearanceIndex index_;
  std::map<int, KeyImage> images_;  // key images by their number in the index
  int saved_ = 0;                   // images below this number were saved as rows
  std::vector<int> forgotten_;      // numbers below saved_ that were forgotten since
};

}  // namespace coslam
