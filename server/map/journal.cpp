// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/map/journal.h"

#include <algorithm>

namespace coslam {
namespace {

constexpr std::array<std::string_view, kEventKinds> kKinds{
    "point_made",   "point_became", "point_fused", "point_removed", "track_bound",   "track_unbound",
    "track_missed", "track_became", "track_ended", "camera_joined", "camera_placed", "camera_lost",
    "camera_left",  "map_started",  "map_merged",  "map_moved"};
constexpr std::array<std::string_view, 3> kPhases{"trial", "static", "moving"};
constexpr std::array<std::string_view, 3> kMotions{"resting", "doubtful", "moving"};

// In the order of Why.
constexpr std::array<WhyText, kWhys> kTexts{{
    {"start_of_map", "at the start of its map, seen by {a} tracks"},
    {"one_cameras_motion", "from one camera's motion: {a} views, standard deviation {b} of the distance"},
    {"two_cameras_now", "from two cameras at once: standard deviation {b} of the distance"},
    {"met_while_moving", "because two tracks that move met at one place: standard deviation {b} of the distance"},
    {"made_from_it", "because the point was made from it"},
    {"registered", "because it is where the point should appear ({a} sigma off) and looks like it (correlation {b})"},
    {"place_recognised", "because the place was recognised ({a} features agree)"},
    {"looks_like_it", "because it is where the moving point should appear and looks like it (correlation {a})"},
    {"outside_gate", "because it was outside the gate {a} times in succession, the last time by {b} sigma"},
    {"odd_one_out", "because without it the {a} other views agree on one place"},
    {"stray", "because it does not lead to where the point was carried ({a} px off)"},
    {"stands_still", "because it stood still for {a} frames, with no other camera to tell how far away"},
    {"other_corner", "because the point stopped, and this track follows a corner {a} px beside it"},
    {"point_gone", "because its point is gone"},
    {"image_ended", "because the agent follows it no longer"},
    {"camera_left", "because its camera left the map"},
    {"no_one_place", "because {a} cameras saw it elsewhere than predicted and did not agree on one place"},
    {"out_of_sight", "because fewer than two cameras saw it for {a} frame sets (limit {b})"},
    {"seen_too_little", "because nobody follows it, and it was seen well only {a} times in {b} frame sets"},
    {"too_few_views", "because the bundle adjustment left {a} of its views"},
    {"undetermined", "because its views do not determine it: standard deviation {a} at a distance of {b}"},
    {"stood_the_trial", "after {a} views inside the gate"},
    {"map_is_new", "because its map has just been started"},
    {"seen_elsewhere", "because {a} cameras see it elsewhere than predicted, and agree where"},
    {"stopped", "because its tracks have not moved against it for {a} frames"},
    {"no_static_place", "because no static place explains it"},
    {"static_place", "because a static place explains it again"},
    {"its_point_moves", "because its point moves"},
    {"one_corner", "because both are one corner: {a} sigma apart in the image, correlation {b}"},
    {"one_mover", "because both were at one place while they moved"},
    {"hello", "the agent said hello"},
    {"restarted", "the agent was started anew"},
    {"started_together", "with {a} cameras that see one scene"},
    {"started_alone", "from its own motion over {a} frame sets"},
    {"no_pose", "too few of its {a} known points agree with any pose ({b} do)"},
    {"maps_met", "because a camera of one recognised a place of the other: scale {a}"},
    {"loop_closed", "because a place was recognised that the map had elsewhere: scale {a}"},
    {"scale_known", "because its scale became known: factor {a}"},
    {"adjusted", "by a bundle adjustment of {a} poses and {b} points"},
}};

template <class Enum, std::size_t N>
std::optional<Enum> found(const std::array<std::string_view, N>& names, std::string_view name) {
  const auto at = std::ranges::find(names, name);
  return at == names.end() ? std::nullopt : std::optional(static_cast<Enum>(at - names.begin()));
}

}  // namespace

const WhyText& text_of(Why why) { return kTexts.at(static_cast<std::size_t>(why)); }
std::string_view name_of(EventKind kind) { return kKinds.at(static_cast<std::size_t>(kind)); }
std::string_view name_of(PointPhase phase) { return kPhases.at(static_cast<std::size_t>(phase)); }
std::string_view name_of(TrackMotion motion) { return kMotions.at(static_cast<std::size_t>(motion)); }
std::optional<EventKind> kind_of(std::string_view name) { return found<EventKind>(kKinds, name); }

std::optional<Why> why_of(std::string_view name) {
  const auto at = std::ranges::find(kTexts, name, &WhyText::name);
  return at == kTexts.end() ? std::nullopt : std::optional(static_cast<Why>(at - kTexts.begin()));
}

}  // namespace coslam
