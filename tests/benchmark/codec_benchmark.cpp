// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the tracks of a frame take on the wire, and to code: against so many tracks by 30 Hz video, each frame coded
// against the one `age` before (0: alone). `over_plain`: bytes over those of an id and two floats a track.
#include <benchmark/benchmark.h>

#include <vector>

#include "common/wire/track_codec.h"
#include "tests/support/moving_tracks.h"

namespace coslam {
namespace {

struct Video {
  std::vector<TrackFrame> frames;
  std::vector<idl::TrackFrame> coded;
  double bytes = 0, plain_bytes = 0;  // a frame
};

std::optional<FrameId> reference_of(FrameId frame, int age) {
  const auto back = static_cast<std::uint32_t>(age);
  return age == 0 || frame.value < back ? std::nullopt : std::optional(FrameId(frame.value - back));
}

Video video(int tracks, int age) {
  constexpr int kFrames = 60;
  Video out;
  test::MovingTracks moving(test::vga_camera(), 30, tracks);
  TrackEncoder encoder(pixel_scale(test::vga_camera()));
  for (int i = 0; i < kFrames; ++i) {
    out.frames.push_back(moving.next());
    out.coded.push_back(encoder.encode(out.frames.back(), reference_of(out.frames.back().frame, age)));
    out.bytes += static_cast<double>(sample_bytes(out.coded.back())) / kFrames;
    out.plain_bytes += static_cast<double>(out.frames.back().tracks.size() * 12) / kFrames;
  }
  return out;
}

void count(benchmark::State& state, const Video& video) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(video.frames.size()));
  state.counters["bytes"] = video.bytes;
  state.counters["over_plain"] = video.bytes / video.plain_bytes;
}

void BM_EncodeVideo(benchmark::State& state) {
  const Video v = video(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  while (state.KeepRunning()) {
    TrackEncoder encoder(pixel_scale(test::vga_camera()));
    for (const TrackFrame& f : v.frames) {
      benchmark::DoNotOptimize(encoder.encode(f, reference_of(f.frame, static_cast<int>(state.range(1)))));
    }
  }
  count(state, v);
}
BENCHMARK(BM_EncodeVideo)->ArgsProduct({{300, 1000}, {0, 1, 3}})->ArgNames({"tracks", "age"});

void BM_DecodeVideo(benchmark::State& state) {
  const Video v = video(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  while (state.KeepRunning()) {
    TrackDecoder decoder;
    for (const idl::TrackFrame& m : v.coded) benchmark::DoNotOptimize(decoder.decode(m));
  }
  count(state, v);
}
BENCHMARK(BM_DecodeVideo)->ArgsProduct({{300, 1000}, {0, 1, 3}})->ArgNames({"tracks", "age"});

}  // namespace
}  // namespace coslam
