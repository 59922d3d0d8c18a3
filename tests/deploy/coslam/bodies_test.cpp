// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/eval/bodies.h"

#include <gtest/gtest.h>

namespace coslam::eval::bodies_test {
namespace {

constexpr TimeNs kFrame_ns = 33'333'333;
constexpr TimeNs at(int instant) { return 10 * kFrame_ns * instant; }

// A man with the points 1 to 12 who walks along x with 1 m/s, before a wall with the points 101 to 112.
class Bodies : public ::testing::Test {
 protected:
  void see(int instant, const std::string& agent, std::uint32_t first, int tracks, bool man, double speed_m_s = 1) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(tracks); ++i) {
      ResultTrackRow row;
      row.t_ns = at(instant);
      row.point = PointId(first + i);
      const Eigen::Vector3d velocity_m_s(man ? speed_m_s : 0, 0, 0);
      tracks_.add(agent, row, {Eigen::Vector3d::Zero(), 3, man ? "person 1" : "", velocity_m_s, velocity_m_s});
    }
  }
  void see_man(int instant, int tracks0, int tracks1, double speed_m_s = 1) {
    see(instant, "cam0", 1, tracks0, true, speed_m_s);
    see(instant, "cam1", 1, tracks1, true, speed_m_s);
  }
  static ResultObjectRow object(int instant, std::uint32_t id, std::vector<PointId> members) {
    // In a map of half the size that is turned by a quarter.
    return {at(instant),       ObjectId(id), Eigen::Vector3d::Zero(), {0, -0.6, 0}, Eigen::Vector3d::Ones(),
            std::move(members)};
  }
  BodyScore score(const std::optional<ObjectsAt>& objects) {
    const auto scores = tracks_.scores(dynamic_, objects, kTruthFromMap, kFrame_ns);
    EXPECT_EQ(scores.size(), 1U);
    return scores.at("person 1");
  }

  const Similarity3 kTruthFromMap{
      2, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), {1, 2, 3}};
  BodyTracks tracks_;
  std::unordered_map<PointId, PointPath> dynamic_;
};

TEST_F(Bodies, AreCoveredByTheirOwnPoints) {
  for (int i = 0; i < 4; ++i) see_man(i, 12, 4);
  see_man(4, 12, 2);         // too few for the second camera
  see_man(5, 12, 12, 0.01);  // he rests
  see(0, "cam0", 101, 12, false);
  dynamic_[PointId(1)] = {{at(0) + kFrame_ns, {}}, {at(1), {}}};
  dynamic_[PointId(101)] = {{at(2), {}}};                // on the wall
  dynamic_[PointId(2)] = {{at(3) + 3 * kFrame_ns, {}}};  // at another time
  const BodyScore found = score(std::nullopt);
  EXPECT_EQ(found.instants, 4);
  EXPECT_DOUBLE_EQ(*found.coverage(), 0.5);
  EXPECT_EQ(found.object_found(), std::nullopt);
  EXPECT_EQ(found.velocity_error_m_s(), std::nullopt);
}

TEST_F(Bodies, AreFoundAsExactlyOneObject) {
  for (int i = 0; i < 4; ++i) see_man(i, 12, 12);
  see_man(4, 12, 11);
  see(0, "cam0", 101, 12, false);
  const PointId man1(1), man2(2), man3(3), wall1(101), wall2(102);
  ObjectsAt objects;
  objects[at(0)] = {object(0, 1, {man1, man2, wall1}), object(0, 2, {wall2, wall1, man3})};
  objects[at(1)] = {object(1, 1, {man1, man2}), object(1, 3, {man3})};  // in two pieces
  objects[at(2) + kFrame_ns] = {object(2, 1, {man1, wall1})};           // half of it is the wall
  objects[at(4)] = {object(4, 1, {man1, man2})};                        // too few tracks then
  const BodyScore found = score(objects);
  EXPECT_EQ(found.object_instants, 4);
  EXPECT_DOUBLE_EQ(*found.object_found(), 0.25);
  EXPECT_NEAR(*found.velocity_error_m_s(), 0.2, 1e-9);
}

TEST(BodyScore, Adds) {
  BodyScore a{4, 2, 2, 1, {0.1}};
  a += BodyScore{6, 6, 2, 2, {0.3, 0.5}};
  EXPECT_DOUBLE_EQ(*a.coverage(), 0.8);
  EXPECT_DOUBLE_EQ(*a.object_found(), 0.75);
  EXPECT_DOUBLE_EQ(*a.velocity_error_m_s(), 0.3);
  EXPECT_EQ(BodyScore().coverage(), std::nullopt);
}

}  // namespace
}  // namespace coslam::eval::bodies_test
