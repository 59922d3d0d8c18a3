// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/why_no_pose.h"

#include <algorithm>
#include <vector>

#include "common/base/printed.h"

namespace coslam {
namespace {

// The fate of most that the server did not use.
ImageFate worst_of(const ImageAccount& images) {
  auto worst = ImageFate::kLeftOut;
  for (std::size_t i = static_cast<std::size_t>(ImageFate::kLeftOut); i < kImageFates; ++i) {
    if (images.images[i] > images[worst]) worst = static_cast<ImageFate>(i);
  }
  return worst;
}

std::string why_not_believed(const std::array<std::uint64_t, kImageFaults>& faults) {
  const auto most = std::ranges::max_element(faults);
  if (*most == 0) return "they were not believed";
  return std::string(words_of(static_cast<ImageFault>(most - faults.begin())).why);
}

}  // namespace

void SeenWithoutPose::look(const MapCamera& camera) {
  most_tracks = std::max(most_tracks, camera.tracks.size());
  if (!camera.frames.empty()) {
    longest_s = std::max(longest_s, to_seconds(camera.frames.back().capture_ns - camera.frames.front().capture_ns));
  }
  std::vector<double> ways_px;
  for (const auto& [id, track] : camera.tracks) {
    ways_px.push_back((track.seen.back().undistorted_px - track.seen.front().undistorted_px).cast<double>().norm());
  }
  if (ways_px.empty()) return;
  const auto middle = ways_px.begin() + std::ssize(ways_px) / 2;
  std::ranges::nth_element(ways_px, middle);
  most_flow_px = std::max(most_flow_px, *middle * 640.0 / camera.model.width_px);
}

std::string late_images(const std::string& agent, std::uint64_t late, std::uint64_t all, TimeNs past_ns) {
  return printed(
      "%llu of %llu images of %s lie before the %.1f s that the map server had reached: start agents that "
      "belong together within 3 s of each other, or name all of them to the server (--set agents=NAME,NAME)",
      static_cast<unsigned long long>(late), static_cast<unsigned long long>(all), agent.c_str(), to_seconds(past_ns));
}

std::string why_no_pose(const ImageAccount& images, const std::array<std::uint64_t, kImageFaults>& faults,
                        const SeenWithoutPose& seen) {
  constexpr std::size_t kFewTracks = 60;
  constexpr double kStill_px = 3, kShort_s = 1, kLittle_px = 16;
  if (images.captured() == 0) return "gave no images";
  const ImageFate worst = worst_of(images);
  const std::uint64_t used =
      images[ImageFate::kTracked] + images[ImageFate::kInOtherMaps] + images[ImageFate::kWithoutPose];
  if (images[worst] > used) {
    const std::string share = printed("%llu of its %llu images are ", static_cast<unsigned long long>(images[worst]),
                                      static_cast<unsigned long long>(images.captured()));
    const std::string because = worst == ImageFate::kLeftOut ? ": " + why_not_believed(faults) : "";
    return "has no pose: " + share + std::string(words_of(worst).after) + because;
  }
  if (seen.most_tracks < kFewTracks) {
    return printed(
        "has no pose: at most %zu corners could be followed; are its images dark, blurred or without texture?",
        seen.most_tracks);
  }
  if (seen.longest_s < kShort_s && seen.most_flow_px < kLittle_px) {
    return printed("has no pose: %llu images over %.1f s are too few to tell how it moved",
                   static_cast<unsigned long long>(used), seen.longest_s);
  }
  if (seen.most_flow_px < kStill_px) {
    return printed(
        "has no pose: it did not move (what it sees moved by %.1f px at most); a map needs views from "
        "different places",
        seen.most_flow_px);
  }
  return "has no pose: what it sees shows no parallax; did it only turn, or hardly move, or is its calibration that of "
         "another camera?";
}

}  // namespace coslam
