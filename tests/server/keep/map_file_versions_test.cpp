// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Map files that earlier versions wrote: two cameras in a room, 45 frames each.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "common/compression/compression.h"
#include "server/estimator/map_server.h"
#include "server/keep/store/map_file.h"
#include "tests/support/map_checks.h"
#include "tests/support/temp_folder.h"

namespace coslam::map_file_versions_test {
namespace {

class MapFileVersions : public testing::TestWithParam<int> {
 protected:
  MapFileVersions() {
    const std::string name = std::string(TEST_DATA) + "/map_version_" + std::to_string(GetParam()) + ".map.zst";
    std::ifstream packed(name, std::ios::binary);
    const std::string octets{std::istreambuf_iterator<char>(packed), {}};
    const auto plain = zstd_decompressed_at_most(octets, 4 << 20);
    if (!plain) throw std::runtime_error(name + " cannot be read");
    std::ofstream(file_, std::ios::binary) << *plain;
  }
  MapServer read() const {
    const MapFile file(file_, MapFile::Access::kRead);
    MapServer server(RunId(1), {});
    server.restore(file.read(), 0, file.version());
    return server;
  }

  const test::TempFolder folder_;
  const std::filesystem::path file_ = folder_ / "kept.map";
};

INSTANTIATE_TEST_SUITE_P(All, MapFileVersions, testing::Values(2));

TEST_P(MapFileVersions, IsRead) {
  EXPECT_EQ(MapFile(file_, MapFile::Access::kRead).version(), GetParam());
  const MapServer server = read();
  EXPECT_EQ(server.map().points().size(), 168U);
  ASSERT_EQ(server.map().cameras().size(), 2U);
  for (const MapCamera& c : server.map().cameras()) EXPECT_EQ(c.frames.size(), 45U);
  EXPECT_EQ(server.map().key_frames().size(), 15U);
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
