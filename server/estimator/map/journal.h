// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/ids.h"
#include "common/base/time.h"
#include "server/estimator/map/states.h"

// Changes in the structure of the map, with reasons: for the result, a viewer, a store, and anyone who asks why a point
// was removed. New estimates of existing entities are no events.
namespace coslam {

enum class EventKind : std::uint8_t {
  kPointMade,
  kPointBecame,  // got another phase
  kPointFused,   // `other` became part of it
  kPointRemoved,
  kTrackBound,
  kTrackUnbound,
  kTrackMissed,  // outside the gate, first of a succession
  kTrackBecame,  // got another motion
  kTrackEnded,
  kCameraJoined,
  kCameraPlaced,
  kCameraLost,   // no pose, first of a succession
  kCameraFound,  // a pose again
  kCameraLeft,   // left its map
  kMapStarted,
  kMapMerged,  // `from` became part of it
  kMapMoved,
  kCameraMisdated,
  kCameraLens,  // lens differs from the calibration, or from what was known until now
};
inline constexpr std::size_t kEventKinds = static_cast<std::size_t>(EventKind::kCameraLens) + 1;

// Reason of a change; each stage gives its own ones. Up to two figures go with each, see text_of().
enum class Why : std::uint8_t {
  // points made
  kStartOfMap,
  kOneCamerasMotion,
  kTwoCamerasNow,
  kMetWhileMoving,
  // tracks bound
  kMadeFromIt,
  kRegistered,
  kPlaceRecognised,
  kLooksLikeIt,
  // tracks unbound, points removed
  kOutsideGate,
  kBehindCamera,
  kOddOneOut,
  kStray,
  kStandsStill,
  kOtherCorner,
  kPointGone,
  kImageEnded,
  kCameraLeft,
  kNoOnePlace,
  kOutOfSight,
  kSeenTooLittle,
  kTooFewViews,
  kUndetermined,
  kShownByOthers,
  // phases and motions
  kStoodTheTrial,
  kMapIsNew,
  kSeenElsewhere,
  kStopped,
  kNoStaticPlace,
  kStaticPlace,
  kOtherWasProven,
  // points fused
  kOneCorner,
  kOneMover,
  // cameras and maps
  kHello,
  kRestarted,
  kStartedTogether,
  kStartedAlone,
  kRig,
  kNoPose,
  kPoseAgain,
  kLostTooLong,
  kMapsMet,
  kLoopClosed,
  kScaleKnown,
  kAdjusted,
  kMovesAtOtherTimes,
  kLensFound,
};
inline constexpr std::size_t kWhys = static_cast<std::size_t>(Why::kLensFound) + 1;

// Name of a reason in files, and a clause for people in which {a} and {b} stand for the figures: it follows what
// happened, as in "it was removed" + " " + clause.
struct WhyText {
  std::string_view name, clause;
};
const WhyText& text_of(Why why);
std::string_view name_of(EventKind kind);
std::string_view name_of(PointPhase phase);
std::string_view name_of(TrackMotion motion);
std::optional<Why> why_of(std::string_view name);
std::optional<EventKind> kind_of(std::string_view name);
// Name of the state that Event::to holds for such an event; empty where it means nothing.
std::string_view name_of_state(EventKind kind, std::uint8_t to);
std::optional<std::uint8_t> state_of(EventKind kind, std::string_view name);

using Figures = std::array<double, 2>;

struct Event {
  SetId set;
  TimeNs t_ns = 0;
  EventKind kind = EventKind::kPointMade;
  Why why = Why::kStartOfMap;
  MapId map, from;       // `from`: the map that was merged
  PointId point, other;  // `other`: the point that was fused
  std::optional<CameraId> camera;
  TrackId track;
  std::uint8_t to = 0;  // phase or motion after the event
  Figures figures{};
};

// Events of the newest frame set, and of what happened since the one before ended: an agent may say hello between two.
// Switched off, it keeps none.
class Journal {
 public:
  void enable(bool on) { on_ = on; }
  bool enabled() const { return on_; }
  void note(const Event& event) {
    if (on_) events_.push_back(event);
  }
  const std::vector<Event>& events() const { return events_; }
  // Forgets the last set's events; events noted since belong to the one that begins.
  void begin_set() {
    events_.erase(events_.begin(), events_.begin() + static_cast<std::ptrdiff_t>(ended_));
    ended_ = 0;
  }
  void end_set() { ended_ = events_.size(); }

 private:
  bool on_ = true;
  std::vector<Event> events_;
  std::size_t ended_ = 0;  // number of events of the set that ended last
};

}  // namespace coslam
