// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/result_past.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "tests/support/temp_folder.h"

namespace coslam::result_past_test {
namespace {

using testing::HasSubstr;

std::string octets(std::size_t size, char c) { return std::string(size, c); }

TEST(SpillFile, GivesBackWhatWasPut) {
  const test::TempFolder folder;
  SpillFile file(folder.path());
  const SpillFile::Ticket a = file.put(octets(1000, 'a')), none = file.put(""), b = file.put(octets(70000, 'b'));
  EXPECT_EQ(file.get(b), octets(70000, 'b'));
  EXPECT_EQ(file.get(a), octets(1000, 'a'));
  EXPECT_EQ(file.get(none), "");
  EXPECT_EQ(file.take_problem(), std::nullopt);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "it has no name";
}

// Where nothing can be written all of it stays in memory, and is written as soon as that is possible.
TEST(SpillFile, KeepsWhatTheDiskDoesNotTake) {
  const test::TempFolder folder;
  SpillFile file(folder.path());
  const SpillFile::Ticket a = file.put(octets(100, 'a'));
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit little{150, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  const SpillFile::Ticket b = file.put(octets(100, 'b')), c = file.put(octets(10, 'c'));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_THAT(file.take_problem().value_or(""), HasSubstr("; mapping goes on, and it is kept in memory"));
  EXPECT_EQ(file.take_problem(), std::nullopt) << "said once";
  EXPECT_EQ(file.get(b), octets(100, 'b'));
  const SpillFile::Ticket d = file.put(octets(10, 'd'));
  EXPECT_EQ(file.get(a), octets(100, 'a'));
  EXPECT_EQ(file.get(b), octets(100, 'b'));
  EXPECT_EQ(file.get(c), octets(10, 'c'));
  EXPECT_EQ(file.get(d), octets(10, 'd'));
  EXPECT_EQ(file.take_problem(), std::nullopt);
}

TEST(ResultPast, KeepsLivePosesAndObjects) {
  const test::TempFolder folder;
  ResultPast past(folder.path());
  EXPECT_TRUE(past.live(CameraId(1), MapId(2)).empty());
  Trajectory path;
  for (int i = 0; i < 10; ++i) {
    path.push_back(
        {i, Rigid3(Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitX())), {1.0 * i, 2, 3})});
  }
  past.add_live(CameraId(1), MapId(2), {path.begin(), path.begin() + 4});
  past.add_live(CameraId(1), MapId(2), {path.begin() + 4, path.end()});
  const Trajectory back = past.live(CameraId(1), MapId(2));
  ASSERT_EQ(back.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(back[i].t_ns, path[i].t_ns);
    EXPECT_EQ(back[i].cam_from_world.translation, path[i].cam_from_world.translation);
    EXPECT_EQ(back[i].cam_from_world.rotation.coeffs(), path[i].cam_from_world.rotation.coeffs());
  }
  past.add_objects({{5, ObjectId(7), {PointId(1), PointId(2)}}, {6, ObjectId(8), {}}});
  ASSERT_EQ(past.object_blocks(), 1U);
  const std::vector<SeenObject> objects = past.objects(0);
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[0].members, (std::vector{PointId(1), PointId(2)}));
  EXPECT_EQ(objects[1].id, ObjectId(8));
}

}  // namespace
}  // namespace coslam::result_past_test
