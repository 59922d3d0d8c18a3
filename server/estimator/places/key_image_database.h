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

// A remembered image shows a place that others show too.
struct LoopCandidate {
  const KeyImage* image = nullptr;
  std::map<TrackId, PointId> own;  // the points that it saw itself
  PlaceMatch place;
};

// Points found near where a camera's pose says: there, or all of them beside it in one way.
struct ExpectedPlace {
  std::vector<std::pair<TrackId, PointId>> there;
  std::optional<PlaceMatch> beside;
};

// Key images of all cameras, found again by appearance and proved by geometry.
class KeyImageDatabase {
 public:
  explicit KeyImageDatabase(const RecogniseConfig& config) : config_(config) {}

  void add(PlaceRecognitionEdit& edit, const DescribedImage& image, const DescriptorReply& reply);
  // Points behind the newest key images of these cameras, not older than `since`, that the camera finds near where its
  // pose says: within gate_px, or farther off, where a drift of the map moved them. Nothing when they are too few.
  ExpectedPlace find_expected(const Map& map, const DescribedImage& image, const DescriptorReply& reply,
                              const std::vector<CameraId>& cameras, SetId since, double gate_px) const;
  // All remembered images of one map, in the order in which they came.
  std::vector<const KeyImage*> images_of(const Map& map, MapId of) const;
  // Maps that images are remembered of.
  std::set<MapId> maps(const Map& map) const;
  // What a remembered image shows of the place that looks most like it, among the key images that may be asked: by the
  // looks of its features and the points behind these.
  std::optional<LoopCandidate> find_again(const Map& map, const KeyImage& image,
                                          const std::function<bool(const KeyImage&, MapId)>& may_ask) const;
  // What another one remembers, as images of a map that was taken in.
  void take_in(const KeyImageDatabase& other, const Renumbered& as);
  // Those images are remembered no more.
  void forget(const std::vector<ImageKey>& views);
  // Of the key images and their index.
  std::size_t bytes() const;
  // The key images as rows, those that were not given out before; and back, in a memory without any.
  void save(std::vector<Row>* rows);
  void restore(const Tables& tables);
  // Where the camera is by the place that looks most like its image, among the key images that may be asked; these have
  // a pose, in the map that is named.
  std::optional<PlaceMatch> find(const Map& map, const DescribedImage& image, const DescriptorReply& reply,
                                 const std::function<bool(const KeyImage&, MapId)>& may_ask) const;

 private:
  struct Asked {
    std::vector<const KeyImage*> images;  // the ones that look most like it, the best first
    MapId in;
  };
  Asked asked_for(const Map& map, const std::vector<std::uint8_t>& descriptors,
                  const std::function<bool(const KeyImage&, MapId)>& may_ask) const;

  RecogniseConfig config_;
  AppearanceIndex index_;
  std::map<int, KeyImage> images_;  // by their numbers in the index
  int saved_ = 0;                   // up to this number they were given out as rows
  std::vector<int> gone_;           // of these, those that were forgotten since
};

}  // namespace coslam
