// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/pose/own_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "agent/pose/turn.h"
#include "common/geometry/rigid3.h"

namespace coslam {
namespace {

constexpr int kColumns = 20, kRows = 15;
constexpr double kLook_s = 0.3, kLongest_s = 1.0;  // between two images that are compared
constexpr double kStands_px = 1, kTurns_px = 5;    // of an image of 640 pixels across
constexpr double kFits = 0.3;                      // of its way, that something far away may miss the turn by
constexpr std::size_t kFewestMoved = 15;           // tracks that moved
constexpr int kLooks = 20, kLooksOfCell = 5;
constexpr double kLeast_s = 8;                                         // from the first of them: things pass sooner
constexpr double kAlways = 0.9, kMostMixed = 0.1, kLeastScene = 0.15;  // shares of the cells that were looked at
constexpr double kOneWay = 0.8;  // length of the mean axis of turns that went one way only

}  // namespace

OwnBody::OwnBody(const CameraModel& camera)
    : camera_(camera), px_(camera.width_px / 640.0), cells_(static_cast<std::size_t>(kColumns) * kRows) {}

OwnBody::Cell& OwnBody::cell_at(const Eigen::Vector2f& raw_px) {
  const auto index = [](float at, int size, int cells) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(at * static_cast<float>(cells) / static_cast<float>(size)), 0, cells - 1));
  };
  return cells_[index(raw_px.y(), camera_.height_px, kRows) * kColumns + index(raw_px.x(), camera_.width_px, kColumns)];
}

bool OwnBody::step(TimeNs capture_ns, const std::vector<Track>& live) {
  const double since_s = before_ns_ ? to_seconds(capture_ns - *before_ns_) : kLongest_s + 1;
  if (since_s < kLook_s) return false;
  bool found = false;
  if (since_s <= kLongest_s) {
    const int looks = looks_;
    look(live);
    if (looks == 0 && looks_ > 0) first_look_ns_ = capture_ns;
    found = looks_ > looks && decide(capture_ns);
  }
  before_ = live;
  before_ns_ = capture_ns;
  return found;
}

OwnBody::Steps OwnBody::steps_of(const std::vector<Track>& live) const {
  Steps out;
  for (const Track& t : live) {
    const auto was = std::ranges::lower_bound(before_, t.id, {}, &Track::id);
    if (was == before_.end() || was->id != t.id) continue;
    const Eigen::Vector2d before_px = was->raw_px.cast<double>(), now_px = t.raw_px.cast<double>();
    const auto before = camera_.undistorted_from_raw(before_px), now = camera_.undistorted_from_raw(now_px);
    if (!before || !now) continue;
    const auto direction = [&](const Eigen::Vector2d& px) {
      return camera_.normalized_from_pixel(px).homogeneous().normalized();
    };
    if ((now_px - before_px).norm() < kStands_px * px_) {
      out.stood.emplace_back(t.raw_px, direction(*before));
    } else {
      out.moved.push_back({before_px, now_px, direction(*before), direction(*now)});
    }
  }
  return out;
}

void OwnBody::look(const std::vector<Track>& live) {
  const auto [moved, stood] = steps_of(live);
  if (moved.size() < kFewestMoved || stood.empty()) return;
  DirectionPairs pairs;
  pairs.reserve(moved.size());
  for (const Pair& p : moved) pairs.emplace_back(p.before, p.now);
  const auto turn_rad = common_turn_rad(pairs);
  if (!turn_rad) return;
  const Eigen::Quaterniond turn = so3_exp(*turn_rad);
  const auto way_px = [&](const Eigen::Vector3d& before) {
    return ((turn * before).hnormalized() - before.hnormalized()).norm() * camera_.focal_px();
  };
  std::vector<const Pair*> turned;
  for (const Pair& p : moved) {
    const double way = way_px(p.before),
                 miss = ((turn * p.before).hnormalized() - p.now.hnormalized()).norm() * camera_.focal_px();
    if (way >= kTurns_px * px_ && miss < kFits * way) turned.push_back(&p);
  }
  // A camera that mostly goes ahead tells nothing: what is far away stands, too.
  if (turned.size() < kFewestMoved || 2 * turned.size() < moved.size()) return;
  ++looks_;
  axes_ += turn_rad->normalized();
  std::vector<std::pair<Cell*, bool>> seen;  // whether something in it stood
  seen.reserve(turned.size() + stood.size());
  for (const Pair* p : turned) seen.emplace_back(&cell_at(p->now_px.cast<float>()), false);
  for (const auto& [px, direction] : stood) {
    if (way_px(direction) >= kTurns_px * px_) seen.emplace_back(&cell_at(px), true);
  }
  std::ranges::sort(seen);
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  for (const auto& [cell, is_stood] : seen) ++(is_stood ? cell->stood : cell->turned);
}

bool OwnBody::decide(TimeNs now_ns) {
  if (looks_ < kLooks || to_seconds(now_ns - first_look_ns_) < kLeast_s || axes_.norm() > kOneWay * looks_)
    return false;
  int known = 0, scene = 0, mixed = 0;
  std::vector<Cell*> body;
  for (Cell& c : cells_) {
    const int looks = c.stood + c.turned;
    if (c.found || looks < kLooksOfCell) continue;
    ++known;
    if (c.stood >= kAlways * looks) {
      body.push_back(&c);
    } else if (c.turned >= kAlways * looks) {
      ++scene;
    } else {
      ++mixed;
    }
  }
  if (body.empty() || mixed > kMostMixed * known || scene < kLeastScene * known) return false;
  for (Cell* c : body) c->found = true;
  return true;
}

ImageParts OwnBody::found() const {
  ImageParts out{kColumns, kRows, std::vector<bool>(cells_.size())};
  for (std::size_t i = 0; i < cells_.size(); ++i) out.cells[i] = cells_[i].found;
  return out;
}

double OwnBody::share() const {
  const auto found = std::ranges::count_if(cells_, &Cell::found);
  return static_cast<double>(found) / static_cast<double>(cells_.size());
}

}  // namespace coslam
