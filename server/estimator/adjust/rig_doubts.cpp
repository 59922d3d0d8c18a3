// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/adjust/rig_doubts.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace coslam {
namespace {

constexpr double kContradictedFor_s = 1;
constexpr double kFarApart_m = 10;  // no body that cameras are fixed to is so large

double degrees(double rad) { return rad * 180 / std::numbers::pi; }

double turn_deg(const Rigid3& t) { return degrees(Eigen::AngleAxisd(t.rotation).angle()); }

// By the rotation, and by the direction in which the one camera lies from the other.
bool alike(const Rigid3& rig, const Rigid3& seen) {
  constexpr double kTurn_deg = 10, kDirection_deg = 60;
  const Eigen::Vector3d by_rig = rig.inverse().translation.normalized(), by_images = seen.inverse().translation;
  return turn_deg(rig * seen.inverse()) < kTurn_deg &&
         by_rig.dot(by_images) > std::cos(kDirection_deg / 180 * std::numbers::pi) * by_images.norm();
}

// The slip in a transform by which it says what the images say, as the end of a sentence; or none.
std::string slip_in(const Rigid3& rig, const Rigid3& seen) {
  const Eigen::Quaterniond& q = rig.rotation;
  const Rigid3 w_first{Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()), rig.translation};
  if (alike(rig.inverse(), seen)) return ": it is the inverse of what is expected, p_in_camera = T * p_in_first";
  if (alike(w_first, seen)) return ": its quaternion is w x y z, x y z w is expected";
  if (alike(w_first.inverse(), seen)) return ": it is the inverse of what is expected, with a quaternion w x y z";
  return "";
}

// Where a camera is and how it is turned, from the one that the transform comes from.
std::string position_text(const Rigid3& cam_from_first) {
  static constexpr const char* kSides[3][2] = {{"left", "right"}, {"above", "below"}, {"behind", "in front"}};
  const Eigen::Vector3d at = cam_from_first.inverse().translation;
  Eigen::Index axis = 0;
  at.cwiseAbs().maxCoeff(&axis);
  char out[64];
  std::snprintf(out, sizeof out, "%s, turned by %.0f degrees", kSides[axis][at[axis] > 0 ? 1 : 0],
                turn_deg(cam_from_first));
  return out;
}

std::string contradiction(const CameraIdentity& first, const MapCamera& camera, const Rigid3& rig, const Rigid3& seen) {
  return "the rig has " + camera.name + " " + position_text(rig) + " against " + first.name + ", the images have it " +
         position_text(seen) + slip_in(rig, seen) +
         "; as long as that is so the rig is left aside, and lengths are not metres";
}

}  // namespace

bool RigDoubts::agrees(const Map& map, const MapCamera& a, const MapCamera& b, const Rigid3& b_from_a) {
  // The rig's transforms are from its first camera.
  const bool from_first = a.name == a.rig || (b.name != b.rig && a.id < b.id);
  if (!from_first) return agrees(map, b, a, b_from_a.inverse());
  const Rigid3 rig = b.cam_from_rig * a.cam_from_rig.inverse();
  const std::pair<CameraId, CameraId> pair(a.id, b.id);
  if (alike(rig, b_from_a)) {
    against_since_.erase(pair);
    return true;
  }
  const SetId first_set = against_since_.try_emplace(pair, map.now()).first->second;
  const bool for_long = map.now().value >= first_set.value + map.sets_in(kContradictedFor_s);
  if (for_long && contradicted_.insert(pair).second) found_.push_back(contradiction(a, b, rig, b_from_a));
  return false;
}

std::vector<std::string> RigDoubts::take(const Map& map) {
  for (const MapCamera& c : map.cameras()) {
    const double apart_m = c.cam_from_rig.translation.norm();
    if (c.rig.empty() || apart_m < kFarApart_m || !measured_.insert(c.id).second) continue;
    found_.push_back("the rig has " + c.name + " " + std::to_string(std::lround(apart_m)) + " m from " + c.rig +
                     ": metres are expected, are these millimetres or centimetres?");
  }
  return std::exchange(found_, {});
}

}  // namespace coslam
