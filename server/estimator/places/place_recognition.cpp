// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/places/place_recognition.h"

#include <algorithm>
#include <utility>

#include "server/estimator/places/unite.h"

namespace coslam {
namespace {

constexpr std::size_t kMostLoops = 200;  // that hold the map together; older ones are in its poses by now

bool together(const ViewGraph& graph, CameraId a, CameraId b) {
  const int group = graph.group_of(a);
  return a == b || (group >= 0 && group == graph.group_of(b));
}

}  // namespace

PlaceRecognitionReport PlaceRecognition::run(PlaceRecognitionEdit& edit, const FrameSet& set, Last<ViewGraph> last,
                                             const ExpectedOverlapReport& expected, const LocaliseConfig& localise,
                                             const AskConfig& ask, Workers& workers) {
  const Map& map = edit.map();
  const Given given{last.of, expected, localise, ask};
  PlaceRecognitionReport report;
  if (map.every(map.config().match_period_s)) remembered_maps_ = places_.maps(map);
  std::vector<const CameraFrame*> described;
  for (const CameraFrame& cf : set.frames) {
    if (cf.descriptors) described.push_back(&cf);
  }
  std::vector<std::optional<Look>> looks(described.size());
  std::size_t looked = 0;  // with the map as it is
  for (std::size_t i = 0; i < described.size(); ++i) {
    if (i == looked) {
      looked = std::min(described.size(), i + workers.at_once());
      workers.each(looked - i, [&](std::size_t j) { looks[i + j].emplace(look(map, *described[i + j], given)); });
    }
    if (act(edit, *looks[i], given, &report)) looked = i + 1;
  }
  for (const CameraFrame* cf : described) awaited_.came(*cf);
  for (const CameraFrame& cf : set.frames) awaited_.await(edit, cf);
  for (std::size_t i = 0; i < described.size(); ++i) {
    const DescribedImage& image = looks[i]->image;
    places_.add(edit, image, *described[i]->descriptors);
    report.described.emplace_back(image.set, image.camera.id);
  }
  return report;
}

PlaceRecognition::Look PlaceRecognition::look(const Map& map, const CameraFrame& frame, const Given& given) const {
  const DescriptorReply& reply = *frame.descriptors;
  Look out{awaited_.image_of(map, frame), {}, {}};
  const MapCamera& camera = out.image.camera;
  if (camera.map != MapId() && !out.image.frame().valid()) return out;
  out.expected = find_expected(map, out.image, reply, given);
  if (!out.expected.in_place.empty()) return out;
  out.seen = places_.find(map, out.image, reply,
                          [&](const KeyImage& i, MapId in) { return may_ask(map, camera, given, i, in); });
  return out;
}

ExpectedPlace PlaceRecognition::find_expected(const Map& map, const DescribedImage& image, const DescriptorReply& reply,
                                              const Given& given) const {
  const auto expected_cameras = given.expected.cameras.find(image.camera.id);
  if (expected_cameras == given.expected.cameras.end()) return {};
  const std::uint32_t lately = 2 * map.sets_in(given.ask.soon_s);
  const SetId first_set(image.set.value - std::min(image.set.value, lately));
  return places_.find_expected(map, image, reply, expected_cameras->second, first_set,
                               PlaceJudge::slack_px(map, image.camera));
}

bool PlaceRecognition::may_ask(const Map& map, const MapCamera& camera, const Given& given, const KeyImage& image,
                               MapId in) const {
  if (camera.map == MapId() || in != camera.map) return true;
  if (!map.is_recent(image.set)) return config.loops;
  const auto expected = given.expected.cameras.find(camera.id);
  return !together(given.graph, camera.id, image.camera) ||
         (expected != given.expected.cameras.end() &&
          std::ranges::find(expected->second, image.camera) != expected->second.end());
}

bool PlaceRecognition::act(PlaceRecognitionEdit& edit, const Look& look, const Given& given,
                           PlaceRecognitionReport* report) {
  using enum PlaceDecision::Action;
  const DescribedImage& image = look.image;
  const MapCamera& camera = image.camera;
  const auto [action, seen, in_from_own, doubt] =
      judge_.decide(edit.map(), image, look.seen, look.expected, given.graph);
  if (doubt != PlaceDoubt::kNone) ++report->doubts.at(static_cast<std::size_t>(doubt));
  report->sightings += action != kUnknown && action != kSeenAsExpected;
  switch (action) {
    case kUnknown:
      return false;
    case kSeenAsExpected:
      bind_matches(edit, image, seen.matches);
      ++report->expected;
      return true;
    case kTooFew:
      report->hinted.push_back(camera.id);
      return false;
    case kDoubtful:
      return false;
    case kPlace:
      place(edit, image, seen, given.localise);
      ++report->placed;
      return true;
    case kLink:
      bind_matches(edit, image, seen.matches);
      ++report->linked;
      return true;
    case kJoin: {
      const MapId own_map = camera.map;
      report->adjust_since = join(edit, image, seen, in_from_own);
      ++report->merged;
      judge_.joined(own_map, seen.map);
      report->to_adjust = camera.map;
      return true;
    }
    case kClose:
      if (!close(edit, image, seen, in_from_own, given.graph, &loops_)) return false;
      if (loops_.size() > kMostLoops) loops_.erase(loops_.begin());
      ++report->closed;
      report->adjust_since = SetId();
      judge_.drawn_together(camera.map);
      report->to_adjust = camera.map;
      return true;
  }
  return false;
}

bool PlaceRecognition::remember_last(KeyImageEdit& edit, CameraId id, const DescriptorReply& reply) {
  const MapCamera& camera = edit.map().camera(id);
  if (camera.run != reply.agent_run) return true;  // of a run before the present one
  if (camera.frames.empty() || camera.frames.back().frame < reply.frame) return false;
  if (camera.frames.back().frame == reply.frame) places_.add(edit, newest_image(camera), reply);
  return true;
}

std::vector<ImageKey> PlaceRecognition::held_frames() const {
  std::vector<ImageKey> out;
  for (const LoopConstraint& l : loops_) {
    out.emplace_back(l.set, l.camera);
    out.emplace_back(l.to_set, l.to_camera);
  }
  return out;
}

void PlaceRecognition::take_in(const PlaceRecognition& other, const Renumbered& renumbered) {
  places_.take_in(other.places_, renumbered);
  for (const LoopConstraint& theirs : other.loops_) Renumber(renumbered).apply(loops_.emplace_back(theirs));
}

OfflineLoopsReport PlaceRecognition::close_loops_offline(PlaceRecognitionEdit& edit, MapId map_id) {
  if (!config.loops) return {};
  return coslam::close_loops_offline(edit, places_, map_id, config.decide.min_merge_inliers, &loops_);
}

}  // namespace coslam
