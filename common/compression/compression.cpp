// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/compression/compression.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "common/base/check.h"

namespace coslam {
namespace {

constexpr std::size_t kFirstRoom = 1U << 16U;
constexpr std::uint64_t kUsualRatio = 256;  // of octets to compressed ones; what claims more is not given room at once

// Room for more output: twice what there was, but no more than `most` in all. False: there is no more.
bool grow(std::string& out, std::size_t most) {
  if (out.size() >= most) return false;
  out.resize(std::min(most, std::max(kFirstRoom, 2 * out.size())));
  return true;
}

struct FreeZstd {
  void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
};
using ZstdStream = std::unique_ptr<ZSTD_DStream, FreeZstd>;

struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

}  // namespace

std::string zstd_compressed(std::string_view octets) {
  constexpr int kLevel = 1;  // 3 and more take twice the time for some percent
  std::string out(ZSTD_compressBound(octets.size()), '\0');
  const std::size_t size = ZSTD_compress(out.data(), out.size(), octets.data(), octets.size(), kLevel);
  COSLAM_CHECK(ZSTD_isError(size) == 0, "compression has all the room that it may need");
  out.resize(size);
  return out;
}

std::optional<std::string> zstd_decompressed(std::string_view octets, std::uint64_t size) {
  const unsigned long long content_size = ZSTD_getFrameContentSize(octets.data(), octets.size());
  if (content_size != ZSTD_CONTENTSIZE_UNKNOWN && content_size != size) return std::nullopt;
  if (content_size == size && size / kUsualRatio <= octets.size()) {  // at once is faster
    std::string out(size, '\0');
    const std::size_t got = ZSTD_decompress(out.data(), out.size(), octets.data(), octets.size());
    return ZSTD_isError(got) == 0 && got == size ? std::optional(std::move(out)) : std::nullopt;
  }
  auto out = zstd_decompressed_at_most(octets, size);
  return out && out->size() == size ? std::move(out) : std::nullopt;
}

bool is_zstd(std::string_view octets) { return octets.starts_with("\x28\xb5\x2f\xfd"); }

std::optional<std::string> zstd_decompressed_at_most(std::string_view octets, std::uint64_t most) {
  const ZstdStream stream(ZSTD_createDStream());
  ZSTD_inBuffer in{octets.data(), octets.size(), 0};
  std::string out;
  std::size_t size = 0, rest = 1;
  while (rest != 0) {
    if (size == out.size()) grow(out, most);  // where nothing may be added, the end of the frame still has to come
    ZSTD_outBuffer room{out.data(), out.size(), size};
    const std::size_t before = in.pos;
    rest = ZSTD_decompressStream(stream.get(), &room, &in);
    if (ZSTD_isError(rest) != 0) return std::nullopt;
    if (rest != 0 && room.pos == size && in.pos == before) return std::nullopt;  // cut off, or too much
    size = room.pos;
    if (rest == 0 && in.pos < in.size) rest = 1;  // another frame follows
  }
  out.resize(size);
  return out;
}

std::optional<std::string> lz4_decompressed(std::string_view octets, std::uint64_t size) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) return std::nullopt;
  const std::unique_ptr<LZ4F_dctx, FreeLz4> context(made);
  std::string out;
  std::size_t done = 0, taken = 0, rest = 1;
  while (rest != 0) {
    if (done == out.size()) grow(out, size);
    std::size_t room = out.size() - done, given = octets.size() - taken;
    rest = LZ4F_decompress(context.get(), out.data() + done, &room, octets.data() + taken, &given, nullptr);
    if (LZ4F_isError(rest) != 0) return std::nullopt;
    if (rest != 0 && room == 0 && given == 0) return std::nullopt;
    done += room;
    taken += given;
  }
  if (done != size) return std::nullopt;
  out.resize(size);
  return out;
}

std::optional<std::string> bzip2_decompressed(std::string_view octets, std::uint64_t size) {
  if (octets.size() > UINT32_MAX) return std::nullopt;
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return std::nullopt;
  const auto end = [](bz_stream* ended) { BZ2_bzDecompressEnd(ended); };
  const std::unique_ptr<bz_stream, decltype(end)> guard(&stream, end);
  stream.next_in = const_cast<char*>(octets.data());  // only read
  stream.avail_in = static_cast<unsigned>(octets.size());
  std::string out;
  std::size_t done = 0;
  int state = BZ_OK;
  while (state != BZ_STREAM_END) {
    if (done == out.size()) grow(out, size);
    const auto room = static_cast<unsigned>(std::min<std::size_t>(out.size() - done, UINT32_MAX));
    stream.next_out = out.data() + done;
    stream.avail_out = room;
    const unsigned before = stream.avail_in;
    state = BZ2_bzDecompress(&stream);
    if (state != BZ_OK && state != BZ_STREAM_END) return std::nullopt;
    done += room - stream.avail_out;
    if (state == BZ_OK && stream.avail_out == room && stream.avail_in == before) return std::nullopt;
  }
  if (done != size) return std::nullopt;
  out.resize(size);
  return out;
}

bool zstd_decompress(std::istream& stream, const std::function<void(std::string_view)>& write) {
  const ZstdStream decompressor(ZSTD_createDStream());
  std::string in(ZSTD_DStreamInSize(), '\0'), out(ZSTD_DStreamOutSize(), '\0');
  std::size_t rest = 1;
  while (stream.read(in.data(), static_cast<std::streamsize>(in.size())) || stream.gcount() > 0) {
    ZSTD_inBuffer given{in.data(), static_cast<std::size_t>(stream.gcount()), 0};
    bool full = true;  // what is held back comes out first
    while (given.pos < given.size || full) {
      ZSTD_outBuffer room{out.data(), out.size(), 0};
      rest = ZSTD_decompressStream(decompressor.get(), &room, &given);
      if (ZSTD_isError(rest) != 0) return false;
      write(std::string_view(out).substr(0, room.pos));
      full = room.pos == out.size();
    }
  }
  return rest == 0;
}

}  // namespace coslam
