// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/export/played_images.h"

#include <memory>

#include "agent/capture/source.h"
#include "common/base/error.h"
#include "common/base/log.h"

namespace coslam::exporting {
namespace {

std::unique_ptr<ImageSource> open_again(const SequenceAgent& agent, double rate_hz, const CameraModel& lens) {
  const LogPause said_when_it_was_played;
  auto source = open_source(agent.source, {agent.start_s, agent.duration_s, rate_hz, lens.width_px, lens.height_px,
                                           agent.calibration.string(), agent.covered, true});
  if (source->live()) throw UserError("agent " + agent.name + ": the images of a live source are gone");
  return source;
}

}  // namespace

std::vector<PlayedImage> PlayedImages::list() const {
  const auto source = open_again(agent_, rate_hz_, lens_);
  std::vector<PlayedImage> out;
  for (FrameId at(0); const auto t_ns = source->peek_ns(); at = FrameId(at.value + 1)) {
    out.push_back({at, *t_ns, source->peek_file()});
    if (!source->skip()) break;
  }
  return out;
}

void PlayedImages::each(std::set<FrameId> frames, const std::function<void(FrameId, const cv::Mat&)>& visit) const {
  if (frames.empty()) return;
  const auto source = open_again(agent_, rate_hz_, lens_);
  for (FrameId at(0); !frames.empty();) {
    if (!frames.contains(at)) {
      if (!source->skip()) break;
      at = FrameId(at.value + 1);
      continue;
    }
    const auto image = next_readable(*source);
    if (!image) break;
    at = FrameId(image->frame.value + 1);
    if (frames.erase(image->frame) > 0) visit(image->frame, image->color.empty() ? image->grey : image->color);
  }
  if (frames.empty()) return;
  throw UserError("agent " + agent_.name + ": " + shown_source(agent_.source) + " has no image " +
                  std::to_string(frames.begin()->value) + ": is that the sequence that was played?");
}

}  // namespace coslam::exporting
