// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/compression/compression.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include <sstream>

#include "tests/common/recording/bag_file.h"

namespace coslam::compression_test {
namespace {

std::string sample(std::size_t size) {
  std::string octets(size, '\0');
  for (std::size_t i = 0; i < size; ++i) octets[i] = static_cast<char>(i * i / 77);
  return octets;
}

struct Kind {
  const char* name;
  std::string (*compressed)(const std::string&);
  std::optional<std::string> (*decompressed)(std::string_view, std::uint64_t);
};

// A stream that does not say how long it is.
std::string zstd_of_no_size(const std::string& octets) {
  ZSTD_CStream* stream = ZSTD_createCStream();
  std::string out(ZSTD_compressBound(octets.size()), '\0');
  ZSTD_outBuffer to{out.data(), out.size(), 0};
  ZSTD_inBuffer from{octets.data(), octets.size(), 0};
  while (ZSTD_compressStream2(stream, &to, &from, ZSTD_e_continue) != 0 && from.pos < from.size) {
  }
  while (ZSTD_compressStream2(stream, &to, &from, ZSTD_e_end) != 0) {
  }
  ZSTD_freeCStream(stream);
  out.resize(to.pos);
  return out;
}

class Compression : public ::testing::TestWithParam<Kind> {};

TEST_P(Compression, ComesBackAsItWas) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{1000}, std::size_t{300'000}}) {
    const std::string octets = sample(size);
    EXPECT_EQ(GetParam().decompressed(GetParam().compressed(octets), size), octets) << size;
  }
}

TEST_P(Compression, AnotherSizeIsRefused) {
  const std::string compressed = GetParam().compressed(sample(1000));
  EXPECT_FALSE(GetParam().decompressed(compressed, 999));
  EXPECT_FALSE(GetParam().decompressed(compressed, 1001));
  EXPECT_FALSE(GetParam().decompressed(compressed, 0));
  EXPECT_FALSE(GetParam().decompressed(compressed, UINT64_MAX)) << "takes no memory for what is not there";
}

TEST_P(Compression, CutOffOrChangedIsRefused) {
  const std::string octets = sample(1000), compressed = GetParam().compressed(octets);
  for (std::size_t size = 0; size < compressed.size(); size += 3) {
    EXPECT_FALSE(GetParam().decompressed(std::string_view(compressed).substr(0, size), 1000)) << size;
  }
  EXPECT_FALSE(GetParam().decompressed("nothing of the kind", 1000));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Compression,
    ::testing::Values(Kind{"zstd", [](const std::string& o) { return zstd_compressed(o); }, zstd_decompressed},
                      Kind{"zstd_of_no_size", zstd_of_no_size, zstd_decompressed},
                      Kind{"lz4", [](const std::string& o) { return recording::test::lz4_frame(o); }, lz4_decompressed},
                      Kind{"bzip2", [](const std::string& o) { return recording::test::bzip2(o); },
                           bzip2_decompressed}),
    [](const auto& kind) { return std::string(kind.param.name); });

TEST(Zstd, AtMostSoMany) {
  const std::string octets = sample(5000), compressed = zstd_compressed(octets);
  EXPECT_TRUE(is_zstd(compressed));
  EXPECT_FALSE(is_zstd(octets));
  EXPECT_EQ(zstd_decompressed_at_most(compressed, 5000), octets);
  EXPECT_EQ(zstd_decompressed_at_most(compressed + compressed, 10'000), octets + octets) << "frames follow each other";
  EXPECT_FALSE(zstd_decompressed_at_most(compressed, 4999));
  EXPECT_FALSE(zstd_decompressed_at_most(compressed.substr(0, compressed.size() - 1), 5000));
}

TEST(Zstd, AStreamComesInPieces) {
  const std::string octets = sample(1'000'000), compressed = zstd_compressed(octets);
  std::string out;
  const auto write = [&](std::string_view more) { out += more; };
  std::istringstream whole(compressed);
  EXPECT_TRUE(zstd_decompress(whole, write));
  EXPECT_EQ(out, octets);
  out.clear();
  std::istringstream cut_off(compressed.substr(0, compressed.size() / 2));
  EXPECT_FALSE(zstd_decompress(cut_off, write));
  EXPECT_TRUE(octets.starts_with(out));
  std::istringstream nothing("");
  EXPECT_FALSE(zstd_decompress(nothing, write));
}

}  // namespace
}  // namespace coslam::compression_test
