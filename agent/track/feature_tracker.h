// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "agent/track/image.h"
#include "common/base/ids.h"
#include "common/model/track_frame.h"

namespace coslam {

// A live feature, raw pixels.
struct Track {
  TrackId id;
  Eigen::Vector2f raw_px = Eigen::Vector2f::Zero();
  std::uint32_t age_frames = 0;  // 0 in the image where it was found
};

// The cells of a grid over the image, by rows, that something is said of.
struct ImageParts {
  int columns = 0, rows = 0;
  std::vector<bool> cells;
};

// Features of one image that have a descriptor, each at a live track.
struct DescribedTracks {
  std::vector<TrackId> tracks;            // ascending
  std::vector<std::uint8_t> descriptors;  // kDescriptorBytes each, as quantised_descriptor() leaves them
};

// Everything that an agent learns from its images: the seam between the estimator and whoever looks at pixels. Each
// call takes and gives a whole batch and is about the newest image, that of the last step(), which the tracker keeps
// (on whatever device it works). Places are raw pixels of that image. The same calls give the same answers.
// Thread-compatible.
class FeatureTracker {
 public:
  virtual ~FeatureTracker() = default;

  // Follows all tracks into `image` (constant size) and starts new ones where there is room. Returns live().
  virtual const std::vector<Track>& step(const Image& image) = 0;

  // The live tracks, ascending id. An id is never used again, and one started later is higher. Valid until the next
  // call that is not const.
  virtual const std::vector<Track>& live() const = 0;

  // The size of the images that are tracked in, against the raw ones.
  virtual double working_scale() const { return 1; }

  // Excludes parts of the image, beside the mask, from the next image on.
  virtual void leave_out(const ImageParts& /*parts*/) {}

  // Ends tracks, those that are missed least first, until there are no more than step() would fill up to or `at_most`
  // were ended.
  virtual void thin(int at_most) = 0;

  // Cuts patches of the image around those of these tracks (ascending) that are live, in their order.
  virtual std::vector<ImagePatch> patches(const std::vector<TrackId>& tracks) = 0;

  // Descriptors of the features of the image that lie at these tracks (ascending), the `most` strongest. What comes
  // back does the work, and may be called once, from any thread and at any time: it has the image and needs nothing of
  // the tracker.
  virtual std::function<DescribedTracks()> describe_at(const std::vector<TrackId>& tracks, int most) = 0;

  // Describes the strongest features wherever they lie. What the work gives is called once, as the tracker's other
  // functions are: features are followed to the newest image, and one at no track there starts a track, beyond what
  // step() would fill up to if need be; the weaker ones are left out once `most_new` were started.
  using StartTracks = std::function<DescribedTracks(int most_new)>;
  virtual std::function<StartTracks()> describe_strongest(int most) = 0;

  // Printed tags, ascending, as they go over the wire. Empty when none are looked for.
  virtual std::vector<TagObservation> tags() = 0;
};

}  // namespace coslam
