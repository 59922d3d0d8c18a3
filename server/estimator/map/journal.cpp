// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/journal.h"

#include <algorithm>

namespace coslam {
namespace {

constexpr std::array<std::string_view, kEventKinds> kKinds{
    "point_made",   "point_became", "point_fused",   "point_removed",   "track_bound", "track_unbound", "track_missed",
    "track_became", "track_ended",  "camera_joined", "camera_placed",   "camera_lost", "camera_found",  "camera_left",
    "map_started",  "map_merged",   "map_moved",     "camera_misdated", "camera_lens"};
constexpr std::array<std::string_view, 3> kPhases{"trial", "static", "moving"};
constexpr std::array<std::string_view, 3> kMotions{"resting", "doubtful", "moving"};

// In the order of Why.
constexpr std::array<WhyText, kWhys> kTexts{{
    {"start_of_map", "at the start of its map, seen by {a} tracks"},
    {"one_cameras_motion", "from one camera's motion: {a} views, standard deviation {b} of its distance"},
    {"two_cameras_now", "from two cameras at once: standard deviation {b} of its distance"},
    {"met_while_moving", "because two tracks that move met at one place: standard deviation {b} of its distance"},
    {"made_from_it", "because the point was made from it"},
    {"registered", "because it is where the point should appear ({a} sigma off) and looks like it (correlation {b})"},
    {"place_recognised", "because the place was recognised ({a} features agree)"},
    {"looks_like_it", "because it is where the moving point should appear and looks like it (correlation {a})"},
    {"outside_gate", "because it was outside the gate {a} times in succession, the last time by {b} sigma"},
    {"behind_camera", "because it was behind the camera, {a} times in succession outside the gate"},
    {"odd_one_out", "because without it the {a} other views agree on one place"},
    {"stray", "because it does not lead to where the point was carried ({a} px off)"},
    {"stands_still", "because it stood still for {a} frames, with no other camera to tell how far away"},
    {"other_corner", "because the point stopped, and this track follows a corner {a} px beside it"},
    {"point_gone", "because its point is gone"},
    {"image_ended", "because its camera follows it no longer, after {a} frame sets"},
    {"camera_left", "because its camera left the map"},
    {"no_one_place", "because several of its {a} tracks were outside the gate, and all agree on no one place"},
    {"out_of_sight", "because fewer than two cameras saw it for {a} frame sets (limit {b})"},
    {"seen_too_little", "because nobody follows it, and it was seen well only {a} times in {b} frame sets"},
    {"too_few_views", "because the bundle adjustment left {a} of its views"},
    {"undetermined", "because its views do not determine it: standard deviation {a} at a distance of {b}"},
    {"shown_by_others", "because it is past and newer images show its place: of its own views {a} are kept"},
    {"stood_the_trial", "after {a} views inside the gate"},
    {"map_is_new", "because its map has just been started"},
    {"seen_elsewhere", "because several of its {a} tracks were outside the gate, and all agree on another place"},
    {"stopped", "because its tracks have not moved against where it is now for {a} frames"},
    {"no_static_place",
     "because no static place explains it or its neighbours: of the tracks around it {a} move and {b} rest"},
    {"static_place",
     "because a static place explains it or its neighbours better than before: of the tracks around it {a} move and "
     "{b} rest"},
    {"other_was_proven", "because the point that becomes part of it was"},
    {"one_corner", "because both are one corner: {a} sigma apart in the image, correlation {b}"},
    {"one_mover", "because both were at one place while they moved"},
    {"hello", "because its agent said hello"},
    {"restarted", "because its agent was started anew"},
    {"started_together", "with {a} cameras that see one scene"},
    {"started_alone", "from its own motion over {a} frame sets"},
    {"rig", "because another camera of its rig has a pose there"},
    {"no_pose", "because too few of the {a} known points that it sees agree with any pose ({b} do)"},
    {"pose_again", "after {a} frame sets without one"},
    {"lost_too_long", "because it had no pose for {a} frame sets"},
    {"maps_met", "because a camera of one recognised a place of the other: scale {a}"},
    {"loop_closed", "because a place was recognised that the map had elsewhere: scale {a}"},
    {"scale_known", "because its scale became known: {a} metres a unit of length"},
    {"adjusted", "by a bundle adjustment of {a} poses and {b} points"},
    {"moves_at_other_times", "because what moves in them moves {a} s earlier than in those of camera number {b}"},
    {"lens_found", "because its images fit a focal length {a} times that of its calibration, and a centre {b} px off"},
}};

template <class Enum, std::size_t N>
std::optional<Enum> found(const std::array<std::string_view, N>& names, std::string_view name) {
  const auto at = std::ranges::find(names, name);
  return at == names.end() ? std::nullopt : std::optional(static_cast<Enum>(at - names.begin()));
}

constexpr bool has_phase(EventKind kind) {
  return kind == EventKind::kPointMade || kind == EventKind::kPointBecame || kind == EventKind::kPointRemoved;
}

constexpr bool has_motion(EventKind kind) { return kind >= EventKind::kTrackBound && kind <= EventKind::kTrackEnded; }

}  // namespace

const WhyText& text_of(Why why) { return kTexts.at(static_cast<std::size_t>(why)); }
std::string_view name_of(EventKind kind) { return kKinds.at(static_cast<std::size_t>(kind)); }
std::string_view name_of(PointPhase phase) { return kPhases.at(static_cast<std::size_t>(phase)); }
std::string_view name_of(TrackMotion motion) { return kMotions.at(static_cast<std::size_t>(motion)); }
std::optional<EventKind> kind_of(std::string_view name) { return found<EventKind>(kKinds, name); }

std::string_view name_of_state(EventKind kind, std::uint8_t to) {
  if (has_phase(kind)) return kPhases.at(to);
  return has_motion(kind) ? kMotions.at(to) : std::string_view();
}

std::optional<std::uint8_t> state_of(EventKind kind, std::string_view name) {
  const auto index = [](auto state) { return state ? std::optional(static_cast<std::uint8_t>(*state)) : std::nullopt; };
  if (has_phase(kind)) return index(found<PointPhase>(kPhases, name));
  if (has_motion(kind)) return index(found<TrackMotion>(kMotions, name));
  return name.empty() ? std::optional<std::uint8_t>(0) : std::nullopt;
}

std::optional<Why> why_of(std::string_view name) {
  const auto at = std::ranges::find(kTexts, name, &WhyText::name);
  return at == kTexts.end() ? std::nullopt : std::optional(static_cast<Why>(at - kTexts.begin()));
}

}  // namespace coslam
