// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>

#include "server/estimator/map/map.h"
#include "server/estimator/places/confirm.h"

namespace coslam {

struct AskConfig {
  double soon_s = 0.2;  // time between requests to a camera that is to be placed, waits to confirm a meeting, or should
                        // see what nothing holds it to
  double least_period_s = 1.0;  // time between requests because the view changed; half of it while there are several
                                // maps or groups; with several maps the view need not have changed
  double images_per_s = 0.5;    // long-run rate for a camera that has a map: descriptors cost 10 kB an image
  double image_burst = 3;       // images that may be saved up ahead of that rate
  double turned_rad = 0.3;      // rotation of the optical axis after which the view counts as changed
  double moved_share = 0.5;     // translation after which the view counts as changed, as a share of the median depth
};

template <class V>
void describe(V& v, AskConfig& c) {
  v.field("soon_s", c.soon_s, {0.01, 100}, "between requests for descriptors where much hangs on them");
  v.field("least_period_s", c.least_period_s, {0.01, 100},
          "the same because the view changed; half of it while there are several maps or groups");
  v.field("images_per_s", c.images_per_s, {0, 100}, "described by a camera that has a map, in the long run");
}

// Reasons to ask a camera for descriptors now.
struct WhyAsk {
  Verification::Waiting waiting = Verification::Waiting::kNothing;  // waits for a second image to confirm a place
  bool expects = false;  // the map says that it sees what another camera sees, and nothing holds the two to each other
  bool apart = false;    // several maps exist
  bool parted = false;   // several groups exist
};

// Decides which camera is asked for the descriptors of an image, within the budget of the uplink.
class Asking {
 public:
  explicit Asking(const AskConfig& config) : config_(config) {}
  DescriptorRequest ask(const Map& map, const MapCamera& camera, const WhyAsk& why);
  void came(CameraId camera, SetId set) { cameras_[camera].at = set; }
  // Notes that the camera may have recognised a place, in too few features to act on it.
  void hint(CameraId camera, SetId set) { cameras_[camera].hinted = set; }

 private:
  struct Described {
    std::optional<SetId> asked, at, hinted;
    double images_to_spare = 0;
    bool in_debt = false;  // confirmations used up the credit: none again until images_to_spare is at least 1
    std::optional<TimeNs> counted_ns;
  };
  double soon_s(const Described& d) const;
  bool wanted(const Map& map, const MapCamera& camera, const Described& d, const WhyAsk& why, bool confirm) const;
  bool afford(Described& d, TimeNs now_ns, bool confirm) const;
  bool view_changed(const Map& map, const MapCamera& camera, SetId earlier_set, double share) const;

  AskConfig config_;
  std::map<CameraId, Described> cameras_;
};

}  // namespace coslam
