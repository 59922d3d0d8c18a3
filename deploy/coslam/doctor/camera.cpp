// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/camera.h"

#include <algorithm>
#include <cmath>

#include "common/base/text.h"
#include "common/base/words.h"

namespace coslam::doctor {
namespace {

std::string in_ms(double value_s) { return format_tenths(1e3 * value_s) + " ms"; }

Finding judge_device(const VideoDevice& device) {
  if (device.forbidden) {
    return {Grade::kFail, device.path, "this user may not open it: " + device.problem,
            "sudo usermod -aG video $USER, then log in again"};
  }
  if (!device.problem.empty()) return {Grade::kWarn, device.path, device.problem, "v4l2-ctl --list-devices"};
  return {Grade::kOk, device.path,
          device.name + ": " + (device.modes.empty() ? "gives no pictures itself" : joined(device.modes))};
}

std::string size_of(const SourceFacts& facts) {
  return std::to_string(facts.width_px) + "x" + std::to_string(facts.height_px);
}

Finding judge_pace(const SourceFacts& facts) {
  const double hz = 1 / facts.period_s;
  const std::string is = size_of(facts) + " at " + format_tenths(hz) + " Hz";
  if (facts.longest_s > 4 * facts.period_s) {
    return {Grade::kWarn, "images",
            is + ", once none for " + in_ms(facts.longest_s) + ": the camera or its cable stalls",
            facts.live ? "another port, a shorter cable, or &format=MJPG" : "record it again"};
  }
  if (facts.live && facts.nominal_hz > 0 && hz < 0.8 * facts.nominal_hz) {
    return {
        Grade::kWarn, "images",
        is + " instead of " + format_tenths(facts.nominal_hz) + ": a longer exposure in the dark, or the bus is full",
        "more light, &format=MJPG after v4l2:N?size=..., or rate_hz: " + format_tenths(hz)};
  }
  return {Grade::kOk, "images", is};
}

// Tells the door's verdict and, where it let them in, what they are like.
Finding judge_picture(const SourceFacts& facts) {
  constexpr double kDark = 25, kDazzled = 230, kClipped = 0.5, kSoft = 0.004;
  const std::string light = "light " + format_tenths(facts.light) + " of 255";
  if (2 * facts.at_fault > facts.images) {
    return {Grade::kFail, "picture",
            "not to be believed: " + std::string(words_of(facts.fault).why) + " (" + light + ")",
            "see docs/inputs.md, what is not believed"};
  }
  if (facts.light < kDark)
    return {Grade::kWarn, "picture", light + ": too dark to follow much", "more light or exposure"};
  if (facts.light > kDazzled || facts.clipped > kClipped) {
    return {Grade::kWarn, "picture", light + ", " + format_tenths(100 * facts.clipped) + " % black or white",
            "less exposure, or none that is automatic"};
  }
  if (facts.sharpness < kSoft) {
    return {Grade::kWarn, "picture", light + ", soft: out of focus, moved, or compressed hard",
            "focus, a clean lens, a shorter exposure"};
  }
  if (facts.at_fault > 0) {
    return {Grade::kWarn, "picture",
            std::to_string(facts.at_fault) + " of " + std::to_string(facts.images) +
                " are left out: " + std::string(words_of(facts.fault).why),
            "see docs/inputs.md, what is not believed"};
  }
  return {Grade::kOk, "picture", light + ", sharp"};
}

Finding judge_stamps(const SourceFacts& facts) {
  constexpr double kLate_s = 0.5;
  if (std::abs(facts.behind_s) > kLate_s) {
    return {Grade::kWarn, "stamps",
            "they are " + format_tenths(std::abs(facts.behind_s)) + " s " +
                (facts.behind_s > 0 ? "behind" : "ahead of") + " the clock of this machine",
            "one clock for all that stamps: chrony or PTP"};
  }
  return {Grade::kOk, "stamps", in_ms(std::max(0.0, facts.behind_s)) + " behind the clock of this machine"};
}

Finding judge_tracking(const SourceFacts& facts) {
  constexpr double kRoom = 0.7, kFew = 0.15;
  const std::string is = in_ms(facts.track_s) + " an image of " + in_ms(facts.period_s) + ", " +
                         std::to_string(facts.tracks) + " of " + std::to_string(facts.most_tracks) + " tracks";
  if (facts.track_s > facts.period_s) {
    return {Grade::kFail, "tracking", is + ": images will be dropped",
            "smaller images, agent.tracker.most_width_px, or fewer: agent.tracker.max_tracks=150"};
  }
  if (facts.track_s > kRoom * facts.period_s) {
    return {Grade::kWarn, "tracking", is + ": little time is left for anything else",
            "smaller images, agent.tracker.most_width_px, or fewer: agent.tracker.max_tracks=150"};
  }
  if (facts.tracks < kFew * facts.most_tracks) {
    return {Grade::kWarn, "tracking", is + ": hardly anything to follow", "point it at something with texture"};
  }
  return {Grade::kOk, "tracking", is};
}

}  // namespace

Findings judge(const std::vector<VideoDevice>& devices) {
  if (devices.empty()) return {{Grade::kOk, "cameras", "no /dev/video* on this machine"}};
  Findings out;
  for (const VideoDevice& device : devices) out.push_back(judge_device(device));
  return out;
}

Findings judge(const SourceFacts& facts) {
  Findings out;
  if (!facts.problem.empty()) {
    out.push_back({Grade::kFail, "source", facts.problem,
                   facts.live ? "v4l2-ctl --list-devices shows cameras, gst-launch-1.0 tries a pipeline"
                              : "docs/inputs.md has what is read as a source"});
  } else {
    out.push_back({Grade::kOk, "source", facts.name});
  }
  if (!facts.calibration_problem.empty()) {
    out.push_back({Grade::kFail, "calibration", facts.calibration_problem,
                   "coslam calibrate makes one; with none the lens is found from the images"});
  } else if (!facts.doubt.empty()) {
    out.push_back({Grade::kWarn, "calibration", facts.doubt, "coslam calibrate makes one"});
  } else if (facts.problem.empty()) {
    out.push_back({Grade::kOk, "calibration", "of the size of its images, and of a likely lens"});
  }
  if (!facts.problem.empty()) return out;
  if (facts.images < 2 || facts.period_s <= 0) {
    out.push_back(
        {Grade::kFail, "images", std::to_string(facts.images) + " in two seconds", "another cable, or fewer pixels"});
    return out;
  }
  out.push_back(judge_pace(facts));
  out.push_back(judge_picture(facts));
  if (facts.live) out.push_back(judge_stamps(facts));
  if (2 * facts.at_fault <= facts.images) out.push_back(judge_tracking(facts));
  return out;
}

}  // namespace coslam::doctor
