// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/motion/objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "deploy/simulation/gait.h"
#include "server/estimator/motion/follow.h"
#include "tests/support/sim_map.h"

// Moving points with the noise of two cameras that look along y, against the bodies that they are on.
namespace coslam::objects_test {
namespace {

using test::median;

constexpr double kRate_hz = 30;
using Place = std::function<Eigen::Vector3d(double t_s)>;

struct Body {
  std::function<Place(std::mt19937_64&)> draw;        // some place on it
  std::function<Eigen::Vector3d(double t_s)> centre;  // whose velocity is that of the body
  int points = 8;                                     // at once
  double life_s = 2;                                  // mean; then another place is followed by another point
  std::function<bool(double)> seen = [](double) { return true; };

  Eigen::Vector3d velocity(double t_s) const { return (centre(t_s + 0.05) - centre(t_s - 0.05)) / 0.1; }
};

Body rigid(const Eigen::Vector3d& start, const Eigen::Vector3d& velocity, const Eigen::Vector3d& half_m) {
  Body b;
  b.centre = [=](double t_s) -> Eigen::Vector3d { return start + t_s * velocity; };
  b.draw = [=](std::mt19937_64& random) -> Place {
    std::uniform_real_distribution<> side(-1, 1);
    const Eigen::Vector3d off(half_m.x() * side(random), half_m.y() * side(random), half_m.z() * side(random));
    return [=](double t_s) -> Eigen::Vector3d { return start + t_s * velocity + off; };
  };
  return b;
}

// Somebody who walks with swinging arms and legs, on a curve.
Body walker(const std::vector<Eigen::Vector2d>& way, double speed_m_s) {
  const sim::GroundPath path(way);
  const sim::Walk walk(sim::Gait(path), speed_m_s, 0, {});
  Body b;
  b.centre = [walk, path](double t_s) -> Eigen::Vector3d {
    const Eigen::Vector2d at = path.at(walk.distance_m(t_s));
    return {at.x(), at.y(), 1};
  };
  b.draw = [walk](std::mt19937_64& random) -> Place {
    struct Limb {
      sim::PersonPart part;
      double from_m, to_m, radius_m;
    };
    static const std::vector<Limb> kLimbs = {
        {sim::kTorso, 0.05, 0.5, 0.15},       {sim::kTorso, 0.05, 0.5, 0.15},
        {sim::kPelvis, -0.1, 0.1, 0.15},      {sim::kHead, 0.05, 0.25, 0.09},
        {sim::kLeftUpperArm, -0.29, 0, 0.05}, {sim::kRightUpperArm, -0.29, 0, 0.05},
        {sim::kLeftForearm, -0.3, 0, 0.04},   {sim::kRightForearm, -0.3, 0, 0.04},
        {sim::kLeftThigh, -0.4, 0, 0.08},     {sim::kRightThigh, -0.4, 0, 0.08},
        {sim::kLeftShank, -0.4, 0, 0.06},     {sim::kRightShank, -0.4, 0, 0.06},
        {sim::kLeftFoot, -0.05, 0.05, 0.08},  {sim::kRightFoot, -0.05, 0.05, 0.08}};
    const Limb limb = kLimbs[std::uniform_int_distribution<std::size_t>(0, kLimbs.size() - 1)(random)];
    const double along = std::uniform_real_distribution<>(limb.from_m, limb.to_m)(random),
                 angle = std::uniform_real_distribution<>(0, 6.28)(random);
    const Eigen::Vector3d in_part(limb.radius_m * std::cos(angle), limb.radius_m * std::sin(angle), along);
    return [=](double t_s) -> Eigen::Vector3d {
      return sim::place_person(walk.at(t_s))[static_cast<std::size_t>(limb.part)] * in_part;
    };
  };
  return b;
}

// What came out, frame by frame, for one body.
struct Followed {
  int frames = 0, as_one = 0;  // one object, of nothing else
  std::vector<ObjectId> ids;   // in succession
  std::vector<double> speed_errors, extents_z;
  double share() const { return static_cast<double>(as_one) / std::max(1, frames); }
};

class Street {
 public:
  explicit Street(std::vector<Body> bodies, unsigned seed = 1) : bodies_(std::move(bodies)), random_(seed) {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      for (int i = 0; i < bodies_[b].points; ++i) slots_.push_back({.body = b});
    }
  }

  std::vector<Followed> run(double seconds, const ObjectsConfig& config = {}) {
    reach_m_ = config.reach_m;
    Objects finder(config);
    std::vector<Followed> out(bodies_.size());
    for (int frame = 0; frame < seconds * kRate_hz; ++frame) {
      observe(frame);
      finder.step(points(), now_ns_);
      for (const MovingObject& o : finder.objects()) all_ids.insert(o.id);
      if (frame > kRate_hz / 2) judge(finder.objects(), frame / kRate_hz, &out);
    }
    return out;
  }

  std::set<ObjectId> all_ids;

 private:
  struct Slot {
    std::size_t body;
    PointId id;
    Place place;
    int until = 0;
    MovingPath path;
    Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  };

  Eigen::Vector3d noise() {
    std::normal_distribution<double> n;
    return {0.01 * n(random_), 0.05 * n(random_), 0.01 * n(random_)};
  }

  void observe(int frame) {
    now_ns_ = to_ns(frame / kRate_hz);
    for (Slot& s : slots_) {
      const Body& body = bodies_[s.body];
      if (!body.seen(frame / kRate_hz)) {
        s.until = 0;
        s.path.clear();
        continue;
      }
      if (frame >= s.until) {
        const double life_s = std::exponential_distribution<>(1 / body.life_s)(random_);
        s = {.body = s.body, .id = PointId(next_++), .place = body.draw(random_), .bias = noise()};
        s.until = frame + 10 + static_cast<int>(life_s * kRate_hz);
        body_of_[s.id] = s.body;
      }
      s.path.push_back(
          {SetId(static_cast<std::uint32_t>(frame)), now_ns_, s.place(frame / kRate_hz) + s.bias + 0.5 * noise()});
      if (s.path.size() > static_cast<std::size_t>(kRate_hz)) s.path.erase(s.path.begin());
    }
  }

  std::vector<MovingPoint> points() const {
    std::vector<MovingPoint> out;
    for (const Slot& s : slots_) {
      if (!s.path.empty()) out.push_back({s.id, MapId(1), s.path, 0.15, reach_m_});
    }
    return out;
  }

  void judge(const std::vector<MovingObject>& objects, double t_s, std::vector<Followed>* out) const {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (!bodies_[b].seen(t_s)) continue;
      Followed& f = (*out)[b];
      ++f.frames;
      std::vector<const MovingObject*> on_body;
      bool pure = true;
      for (const MovingObject& o : objects) {
        const auto own =
            std::count_if(o.members.begin(), o.members.end(), [&](PointId id) { return body_of_.at(id) == b; });
        if (own > 0) on_body.push_back(&o);
        pure &= own == 0 || own == static_cast<std::ptrdiff_t>(o.members.size());
      }
      if (on_body.size() != 1 || !pure) continue;
      ++f.as_one;
      const MovingObject& o = *on_body.front();
      if (f.ids.empty() || f.ids.back() != o.id) f.ids.push_back(o.id);
      f.speed_errors.push_back((o.motion.velocity - bodies_[b].velocity(t_s)).norm());
      f.extents_z.push_back(o.motion.extent.z());
    }
  }

  std::vector<Body> bodies_;
  std::mt19937_64 random_;
  std::vector<Slot> slots_;
  std::map<PointId, std::size_t> body_of_;
  std::uint32_t next_ = 1;
  TimeNs now_ns_ = 0;
  double reach_m_ = 0;
};

const std::vector<Eigen::Vector2d> kRound = {{-1.9, 0.9}, {-1.2, 0.0}, {0.0, -0.25}, {1.2, 0.0},
                                             {1.9, 0.9},  {1.3, 2.0},  {0.0, 2.4},   {-1.3, 2.0}};

class Walkers : public testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Walkers, testing::Range(1U, 9U));

TEST_P(Walkers, AreOneObjectWithTheirLimbs) {
  Street street({walker(kRound, 1.2)}, GetParam());
  const Followed f = street.run(20)[0];
  EXPECT_GT(f.share(), 0.85);
  EXPECT_LE(f.ids.size(), 2U);
  EXPECT_LT(median(f.speed_errors), 0.3) << "few points, most of them on limbs, as it is known at the time";
  EXPECT_GT(median(f.extents_z), 0.7);
  EXPECT_LT(median(f.extents_z), 2.0);
}

TEST_P(Walkers, KeepTheirIdThoughNoPointLivesLong) {
  Body body = walker(kRound, 1.2);
  body.points = 12;
  body.life_s = 0.3;
  Street street({body}, GetParam());
  const Followed f = street.run(20)[0];
  EXPECT_GT(f.share(), 0.9);
  EXPECT_LE(f.ids.size(), 2U);
}

TEST_P(Walkers, SideBySideAreTwo) {
  const std::vector<Eigen::Vector2d> way = {{0, 0}, {8, 0}, {16, 0}, {24, 0}, {32, 3}, {32, 20}, {0, 20}, {-6, 3}};
  std::vector<Eigen::Vector2d> beside = way;
  for (Eigen::Vector2d& p : beside) p.y() += 1.5;
  Street street({walker(way, 1.2), walker(beside, 1.2)}, GetParam());
  for (const Followed& f : street.run(12)) {
    EXPECT_GT(f.share(), 0.9);
    EXPECT_EQ(f.ids.size(), 1U);
  }
}

TEST_P(Walkers, ThatCrossACartAndEachOtherAreTold) {
  Street street({walker(kRound, 1.2), rigid({-4, 0.5, 0.5}, {1.0, 0, 0}, {0.4, 0.3, 0.4}),
                 rigid({6, 1.0, 0.9}, {-1.2, 0, 0}, {0.2, 0.2, 0.8})},
                GetParam());
  for (const Followed& f : street.run(10)) {
    EXPECT_GT(f.share(), 0.8);
    EXPECT_LE(f.ids.size(), 2U);
  }
}

TEST(Objects, ABodyThatIsSeenAgainSoonIsTheSame) {
  Body body = rigid({-3, 0, 1}, {1.0, 0, 0}, {0.2, 0.2, 0.5});
  body.seen = [](double t_s) { return t_s < 2 || t_s > 2.4; };
  EXPECT_EQ(Street({body}).run(5)[0].ids.size(), 1U) << "by other points, where it had to be by then";
  body.seen = [](double t_s) { return t_s < 2 || t_s > 3.5; };
  EXPECT_EQ(Street({body}).run(5)[0].ids.size(), 2U);
}

TEST(Objects, TheVelocityOfARigidBodyIsItsOwn) {
  Body body = rigid({-3, 0, 1}, {0.8, 0.3, 0}, {0.3, 0.2, 0.5});
  const Followed f = Street({body}).run(6)[0];
  EXPECT_GT(f.share(), 0.98);
  EXPECT_LT(median(f.speed_errors), 0.08);
}

TEST(Objects, WhatStandsStillIsNone) {
  Street street({rigid({0, 0, 1}, {0, 0, 0}, {0.3, 0.3, 0.5})});
  street.run(3);
  EXPECT_TRUE(street.all_ids.empty());
}

TEST(Objects, TwoPointsAreTooFewToBegin) {
  Body body = rigid({0, 0, 1}, {1, 0, 0}, {0.3, 0.3, 0.5});
  body.points = 2;
  Street street({body});
  street.run(3);
  EXPECT_TRUE(street.all_ids.empty());
}

MovingPoint steady(std::uint32_t id, const Eigen::Vector3d& at, double sigma) {
  MovingPoint p{PointId(id), MapId(1), {}, sigma, 0.9};
  for (std::uint32_t i = 0; i < 30; ++i) {
    p.path.push_back({SetId(i), to_ns(i / kRate_hz), at + i / kRate_hz * Eigen::Vector3d::UnitX()});
  }
  return p;
}

TEST(Objects, UncertainPointsAndThoseOfOtherMapsStayOut) {
  std::vector<MovingPoint> points;
  for (std::uint32_t i = 0; i < 5; ++i) points.push_back(steady(1 + i, {0, 0, 0.2 * i}, 0.1));
  points.push_back(steady(6, {0, 0.1, 0}, 0.5));
  points.push_back(steady(7, {0, 0.1, 0}, 0.1));
  points.back().map = MapId(2);
  Objects finder(ObjectsConfig{});
  EXPECT_EQ(finder.step(points, points[0].path.back().t_ns).objects, 1);
  EXPECT_THAT(finder.objects().at(0).members,
              testing::ElementsAre(PointId(1), PointId(2), PointId(3), PointId(4), PointId(5)));
  EXPECT_NEAR((finder.objects()[0].motion.velocity - Eigen::Vector3d::UnitX()).norm(), 0, 1e-6);
  EXPECT_NEAR((finder.objects()[0].motion.extent - Eigen::Vector3d(0, 0, 0.8)).norm(), 0, 1e-6);
}

TEST(Objects, AStrayPointDoesNotWidenTheBox) {
  std::vector<PointMotion> points(8);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].position.x() = 0.1 * static_cast<double>(i);
  points.push_back(points[3]);
  points.back().position.x() = 5;
  const BodyMotion body = body_of(points);
  EXPECT_NEAR(body.centroid.x(), 0.35, 0.01);
  EXPECT_NEAR(body.extent.x(), 0.7, 0.01);
}

// A map with one body of 25 moving points, two cameras at their true poses, and the path of their tracks.
class ObjectsOfAMap : public testing::Test {
 protected:
  ObjectsOfAMap() : sim_(world_, test::paths_side_by_side(2), {.noise_px = 0.1, .max_tracks = 400}) {
    sim_.advance(20);
    for (int i = 300; i < world_.size(); ++i) {
      if (!sim_.all_follow(i)) continue;
      const MapPoint& p = sim_.add_point(i, 0.02, Eigen::Vector3d::Zero(), PointPhase::kMoving);
      record_past(sim_.edit, p, 20);
      sim_.record_now(p);
    }
  }

  const test::SimWorld world_{{.points = 300, .moving_points = 25}};
  test::SimMap sim_;
  Objects finder_{ObjectsConfig{}};
};

TEST_F(ObjectsOfAMap, NewPointsThatHaveAPathMakeAnObject) {
  const ObjectsReport r = finder_.run(sim_.map, sim_.set, {.in_metres = {sim_.id}});
  EXPECT_GT(r.points, 8);
  ASSERT_EQ(r.objects, 1);
  const TimeNs now_ns = sim_.set.t_ns;
  const Eigen::Vector3d velocity = (world_.position(300, now_ns) - world_.position(300, now_ns - to_ns(0.01))) / 0.01;
  EXPECT_LT((finder_.objects()[0].motion.velocity - velocity).norm(), 0.3);
}

TEST_F(ObjectsOfAMap, PathsFollowTheMapWhenItIsMoved) {
  finder_.run(sim_.map, sim_.set, {.in_metres = {sim_.id}});
  ASSERT_EQ(finder_.objects().size(), 1U);
  const BodyMotion before = finder_.objects()[0].motion;
  const Similarity3 moved{2, Eigen::Quaterniond(Eigen::AngleAxisd(1, Eigen::Vector3d::UnitY())), {1, 2, 3}};
  sim_.edit.transform(sim_.id, moved, Why::kScaleKnown);
  finder_.run(sim_.map, sim_.set, {});
  ASSERT_EQ(finder_.objects().size(), 1U);
  const BodyMotion& after = finder_.objects()[0].motion;
  EXPECT_LT((after.centroid - moved * before.centroid).norm(), 1e-6);
  EXPECT_LT((after.velocity - 2 * (moved.rotation * before.velocity)).norm(), 0.02) << "a median of each coordinate";
}

}  // namespace
}  // namespace coslam::objects_test
