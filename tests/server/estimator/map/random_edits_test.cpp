// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "server/estimator/map/edit.h"
#include "tests/support/map_checks.h"
#include "tests/support/sim_map.h"

// Hundreds of edits, and what the map says of itself afterwards.
namespace coslam::random_edits_test {
namespace {

// Edits at random, honest ones among them, in a world with few points, so that they meet. What the map is asked is
// compared with a scan over all of it.
class RandomEdits {
 public:
  explicit RandomEdits(unsigned seed, bool journal)
      : random_(seed), sim_(world_, test::paths_side_by_side(3), {.ends = 0.05}, {.recent_s = 12.0 / 30}) {
    test::forget(sim_.edit.journal());
    sim_.edit.journal().enable(journal);
  }

  void step() {
    sim_.ingest(chance() < 0.3);
    for (const MapCamera& c : sim_.map.cameras()) {
      if (chance() < 0.9) sim_.place_truly(c.id);
    }
    for (int i = 0; i < 12; ++i) {
      edit_something();
      remember();
    }
  }
  void expect_sound() const {
    const Map& map = sim_.map;
    test::expect_consistent(map);
    EXPECT_EQ(map.recent_points(), test::scan(map, [&](const MapPoint& p) { return map.is_recent(p.last_seen); }));
    for (const std::uint32_t back : {0U, 1U, 5U, 12U, 13U, 40U}) {
      const SetId since(map.now().value - std::min(map.now().value, back));
      EXPECT_EQ(map.points_seen_since(since), test::scan(map, [&](const MapPoint& p) { return p.last_seen >= since; }));
      expect_observed(map.points_observed_since(since), [&](SetId s) { return s >= since; });
      expect_observed(map.points_observed_at({since, SetId(3)}), [&](SetId s) { return s == since || s == SetId(3); });
    }
    const auto loose = test::scan(map, [&](const MapPoint& p) { return p.bound.empty() && !kept_.contains(p.id); });
    EXPECT_EQ(std::vector<PointId>(map.untracked_points().begin(), map.untracked_points().end()), ids_of(loose));
  }
  const test::SimMap& sim() const { return sim_; }
  int edits() const { return edits_; }

 private:
  double chance() { return std::uniform_real_distribution<>(0, 1)(random_); }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }
  const MapPoint& any_point() {
    return std::next(sim_.map.points().begin(), static_cast<int>(below(points())))->second;
  }
  const MapCamera& any_camera() { return sim_.map.cameras()[below(sim_.map.cameras().size())]; }
  std::size_t points() const { return sim_.map.points().size(); }
  // Null when the camera has none that is (or is not) bound.
  const ServerTrack* any_track(const MapCamera& c, bool bound) {
    std::vector<const ServerTrack*> some;
    for (const auto& [id, t] : c.tracks) {
      if (t.bound() == bound) some.push_back(&t);
    }
    return some.empty() ? nullptr : some[below(some.size())];
  }
  static std::vector<PointId> ids_of(const std::vector<const MapPoint*>& points) {
    std::vector<PointId> out;
    for (const MapPoint* p : points) out.push_back(p->id);
    return out;
  }

  void edit_something() {
    ++edits_;
    if (points() < 8 || chance() < 0.2) {
      make_point();
    } else if (chance() < 0.4) {
      edit_track(any_camera());
    } else if (chance() < 0.6) {
      edit_point(any_point());
    } else if (chance() < 0.6) {
      change_phase(any_point());
    } else {
      edit_map();
    }
  }
  void make_point() {
    const PointPhase phase = static_cast<PointPhase>(below(3));
    const Eigen::Vector3d off_m(0.01 * chance(), 0, 0);
    if (chance() < 0.3) {
      sim_.create({chance(), chance(), 4 + chance()}, 0.1, phase);
    } else {
      sim_.add_point(static_cast<int>(below(static_cast<std::size_t>(world_.size()))), 0.01, off_m, phase);
    }
  }
  void edit_track(const MapCamera& c) {
    MapEdit& edit = sim_.edit;
    if (const ServerTrack* t = any_track(c, false); t != nullptr && chance() < 0.5) {
      const MapPoint& p = any_point();
      if (p.moves()) {
        edit.bind_moving(p, c.id, *t, {1, 0}, Why::kLooksLikeIt);
      } else {
        edit.bind(p, c.id, *t, Why::kRegistered);
      }
    } else if (const ServerTrack* bound = any_track(c, true)) {
      switch (below(5)) {
        case 0:
          return edit.unbind(c.id, *bound, Why::kOutsideGate);
        case 1:
          edit.miss_gate(c.id, *bound, 3);
          return;
        case 2:
          return edit.pass_gate(*bound);
        case 3:
          return edit.distrust_before(*bound, sim_.set.id);
        default:
          return edit.give_patch(*sim_.map.find(bound->point), c.id, *bound);
      }
    }
  }
  void edit_point(const MapPoint& p) {
    MapEdit& edit = sim_.edit;
    switch (below(9)) {
      case 0:
        return edit.remove_point(p, Why::kTooFewViews);
      case 1:
        return edit.forget_past(p);
      case 2:
        return edit.keep_recent(p);
      case 3:
        return edit.fuse(p.id, any_point().id, Why::kOneCorner);
      case 4:
        if (p.key_observations.empty()) return;
        return edit.drop_observation(p, p.key_observations.front().set, p.key_observations.front().camera,
                                     p.key_observations.front().track);
      case 5:
        if (!p.bound.empty()) return;
        kept_.insert(p.id);
        return edit.keep_untracked(p.id);
      case 6:
        return edit.record_motion(p.id, {sim_.set.id, sim_.set.t_ns, {}});
      case 7:
        return edit.follow(p, p.position + Eigen::Vector3d(0.01, 0, 0), p.covariance);
      default:
        return edit.see(p);
    }
  }
  void change_phase(const MapPoint& p) {
    MapEdit& edit = sim_.edit;
    if (p.moves()) {
      edit.stop_moving(p, 3);
    } else if (chance() < 0.5) {
      sim_.set_moving(p);
    } else if (chance() < 0.9) {
      edit.prove(p);
    } else {
      edit.put_on_trial(sim_.id, Why::kMapIsNew);
    }
  }
  void edit_map() {
    MapEdit& edit = sim_.edit;
    const SetId now = sim_.set.id, some(now.value - static_cast<std::uint32_t>(below(std::min(20U, now.value + 1))));
    switch (below(8)) {
      case 0:
        return edit.add_key_frame(now, {CameraId(static_cast<std::uint16_t>(now.value % 2))});
      case 1:
        return edit.add_key_frame(some);
      case 2:
        return edit.add_key_image(now, any_camera().id);
      case 3:
        return edit.thin_patches(4);
      case 4:
        return edit.transform(sim_.id, {1.01, Eigen::Quaterniond::Identity(), {0.01, 0, 0}}, Why::kAdjusted);
      case 5:
        if (chance() < 0.2) edit.leave_map(any_camera());
        return;
      case 6:
        if (chance() < 0.1) edit.restart_camera(any_camera().id, RunId(500), test::sim_camera());
        return;
      default:
        const MapId other = edit.new_map(Why::kStartedAlone, 1);
        sim_.create(other, {0, 0, 5});
        return edit.merge(other, sim_.id, Similarity3());
    }
  }

  // What a query may answer with although the observation is gone by now; and which points are loose for others.
  void remember() {
    for (const auto& [id, p] : sim_.map.points()) {
      if (!p.bound.empty()) kept_.erase(id);
      if (p.moves()) moved_.insert(id);
      for (const KeyObservation& o : p.key_observations) once_observed_[id].insert(o.set);
    }
  }
  template <class In>
  void expect_observed(const std::vector<const MapPoint*>& answer, In in) const {
    EXPECT_TRUE(std::ranges::is_sorted(answer, {}, &MapPoint::id));
    EXPECT_EQ(std::ranges::adjacent_find(answer), answer.end());
    for (const MapPoint* p : test::scan(sim_.map, [&](const MapPoint& q) {
           return std::ranges::any_of(q.key_observations, in, &KeyObservation::set);
         })) {
      EXPECT_TRUE(std::ranges::binary_search(answer, p->id, {}, &MapPoint::id)) << p->id.value;
    }
    for (const MapPoint* p : answer) {
      const auto once = once_observed_.find(p->id);
      EXPECT_TRUE(moved_.contains(p->id) || (once != once_observed_.end() && std::ranges::any_of(once->second, in)))
          << p->id.value;
    }
  }

  std::mt19937_64 random_;
  const test::SimWorld world_{{.points = 60}};
  test::SimMap sim_;
  std::set<PointId> kept_;  // loose, but worth keeping
  std::map<PointId, std::set<SetId>> once_observed_;
  std::set<PointId> moved_;  // their tracks' observations came and went at once
  int edits_ = 0;
};

class RandomEditsTest : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, RandomEditsTest, testing::Range(1U, 5U));

TEST_P(RandomEditsTest, QueriesSayWhatAScanSays) {
  RandomEdits run(GetParam(), true);
  for (int i = 0; i < 80 && !HasFailure(); ++i) {
    run.step();
    run.expect_sound();
  }
  EXPECT_EQ(run.edits(), 80 * 12);
  EXPECT_GT(run.sim().map.points().size(), 20U);
  EXPECT_LT(run.sim().map.recent_points().size(), run.sim().map.points().size()) << "some are old";
}

// As rows, of which only those that changed were given out after each step, and back.
TEST_P(RandomEditsTest, OutlivesItsServer) {
  RandomEdits run(GetParam(), false);
  MapRows rows;
  Tables tables;
  const auto keep = [](std::vector<Row> changes, Tables* in) {
    for (Row& row : changes) {
      if (row.bytes.empty()) {
        EXPECT_EQ((*in)[row.table].erase(row.key), 1U) << "only what was there goes";
      } else {
        (*in)[row.table][row.key] = std::move(row.bytes);
      }
    }
  };
  std::size_t given = 0;
  for (int i = 0; i < 80; ++i) {
    run.step();
    auto changes = rows.changes(run.sim().map);
    given = changes.size();
    keep(std::move(changes), &tables);
  }
  MapEdit other(run.sim().map.config());
  other.restore(tables);
  test::expect_consistent(other.map());
  EXPECT_EQ(test::Difference(test::Compared::kKept).of(other.map(), run.sim().map), "");
  EXPECT_LT(given, tables["frame"].size()) << "not everything every time";
  EXPECT_EQ(other.map().recent_points().size(), run.sim().map.recent_points().size());
}

TEST(RandomEditsJournal, IsTheSameMapWithAndWithout) {
  RandomEdits with(7, true), without(7, false);
  for (int i = 0; i < 40; ++i) {
    with.step();
    without.step();
  }
  EXPECT_GT(with.sim().edit.journal().events().size(), 400U);
  EXPECT_TRUE(without.sim().edit.journal().events().empty());
  ASSERT_EQ(with.sim().map.points().size(), without.sim().map.points().size());
  for (const auto& [id, p] : with.sim().map.points()) {
    const MapPoint* same = without.sim().map.find(id);
    ASSERT_NE(same, nullptr);
    EXPECT_EQ(p.position, same->position);
    EXPECT_EQ(p.bound, same->bound);
    EXPECT_EQ(p.phase, same->phase);
  }
}

}  // namespace
}  // namespace coslam::random_edits_test
