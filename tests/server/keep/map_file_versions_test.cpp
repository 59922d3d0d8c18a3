// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Map files that earlier versions wrote: two cameras in a room, 45 frames each.
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "server/estimator/map_server.h"
#include "server/keep/store/map_file.h"
#include "tests/support/kept_files.h"
#include "tests/support/map_checks.h"
#include "tests/support/temp_folder.h"

namespace coslam::map_file_versions_test {
namespace {

struct KeptMap {
  int version;
  std::size_t points, key_frames;
};
void PrintTo(const KeptMap& kept, std::ostream* out) { *out << kept.version; }

class MapFileVersions : public testing::TestWithParam<KeptMap> {
 protected:
  MapFileVersions() { test::unpack_kept("map_version_" + std::to_string(GetParam().version) + ".map", file_); }
  MapServer read() const {
    const MapFile file(file_, MapFile::Access::kRead);
    MapServer server(RunId(1), {});
    server.restore(file.read(), 0, file.version());
    return server;
  }

  const test::TempFolder folder_;
  const std::filesystem::path file_ = folder_ / "kept.map";
};

INSTANTIATE_TEST_SUITE_P(All, MapFileVersions, testing::Values(KeptMap{2, 168, 15}, KeptMap{3, 523, 7}));

TEST_P(MapFileVersions, IsRead) {
  EXPECT_EQ(MapFile(file_, MapFile::Access::kRead).version(), GetParam().version);
  const MapServer server = read();
  EXPECT_EQ(server.map().points().size(), GetParam().points);
  ASSERT_EQ(server.map().cameras().size(), 2U);
  for (const MapCamera& c : server.map().cameras()) EXPECT_EQ(c.frames.size(), 45U);
  EXPECT_EQ(server.map().key_frames().size(), GetParam().key_frames);
  test::expect_consistent(server.map());
}

TEST_P(MapFileVersions, IsOfThisVersionOnceItIsWrittenTo) {
  MapServer server = read();
  MapFile(file_, MapFile::Access::kWrite).write(server.changed_rows(), 1);
  const MapFile file(file_, MapFile::Access::kRead);
  EXPECT_EQ(file.version(), kRowsVersion);
  MapEdit again{MapConfig()};
  again.restore(file.read());
  EXPECT_EQ(test::Difference(test::Compared::kKept).of(again.map(), server.map()), "");
}

}  // namespace
}  // namespace coslam::map_file_versions_test
