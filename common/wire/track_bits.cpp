// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/track_bits.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "common/base/check.h"
#include "common/wire/bits.h"
#include "common/wire/track_motion.h"

namespace coslam {
namespace {

constexpr int kCountBits = 12;  // 0 to idl::MAX_TRACKS
constexpr int kIdBits = 32;
constexpr int kUnitBits = 16;
constexpr int kResidualBits = 17;  // of a difference of two coordinates, its sign last
static_assert(idl::MAX_TRACKS < 1U << kCountBits);

std::uint32_t folded(std::int32_t v) {
  return v >= 0 ? 2 * static_cast<std::uint32_t>(v) : 2 * static_cast<std::uint32_t>(-v) - 1;
}
std::int32_t unfolded(std::uint32_t v) {
  const auto half = static_cast<std::int32_t>(v / 2);
  return v % 2 == 0 ? half : -half - 1;
}

struct Kept {
  std::uint32_t track = 0;
  Step step;
};

// The tracks of a frame, and what became of those of its reference.
struct Split {
  std::vector<std::uint32_t> missing;  // places in the reference
  std::vector<Kept> kept_tracks;
  CodedTracks fresh;
};

Split split(const CodedTracks& tracks, const CodedTracks& reference) {
  Split s;
  auto at = tracks.begin();
  for (std::uint32_t place = 0; place < reference.size(); ++place) {
    const CodedTrack& before = reference[place];
    for (; at != tracks.end() && at->track < before.track; ++at) s.fresh.push_back(*at);
    if (at == tracks.end() || at->track != before.track) {
      s.missing.push_back(place);
    } else {
      s.kept_tracks.push_back({before.track, {before.at, at->at}});
      ++at;
    }
  }
  s.fresh.insert(s.fresh.end(), at, tracks.end());
  return s;
}

std::uint32_t last_of(const CodedTracks& reference) { return reference.empty() ? 0 : reference.back().track; }

Units centre_of(const std::vector<Kept>& kept_tracks) {
  std::vector<Units> from;
  from.reserve(kept_tracks.size());
  for (const Kept& k : kept_tracks) from.push_back(k.step.from);
  return centre_of(from);
}

void put_missing(BitWriter& out, const std::vector<std::uint32_t>& missing) {
  out.put(missing.size(), kCountBits);
  std::vector<std::uint32_t> steps;
  std::uint32_t next = 0;
  for (const std::uint32_t place : missing) {
    steps.push_back(place - next);
    next = place + 1;
  }
  if (!missing.empty()) out.put_list(steps, kCountBits);
}

void put_fresh_ids(BitWriter& out, const CodedTracks& fresh, std::uint32_t above) {
  if (fresh.empty()) return;
  const bool first_is_above = fresh.front().track > above;
  out.put(first_is_above ? 1 : 0, 1);
  std::uint32_t before = first_is_above ? above : 0;
  std::vector<std::uint32_t> steps;
  for (const CodedTrack& t : fresh) {
    steps.push_back(t.track - before - 1);
    before = t.track;
  }
  out.put_list(steps, kIdBits);
}

void put_kept(BitWriter& out, const std::vector<Kept>& kept_tracks) {
  if (kept_tracks.empty()) return;
  const Units centre = centre_of(kept_tracks);
  std::vector<Step> steps;
  steps.reserve(kept_tracks.size());
  for (const Kept& k : kept_tracks) steps.push_back(k.step);
  const MotionParameters parameters = fit_motion(centre, steps);
  for (const std::int16_t p : parameters) out.put(static_cast<std::uint16_t>(p), kUnitBits);
  TrackPredictor predictor(CommonMotion(centre, parameters), kept_tracks.size());
  std::vector<std::uint32_t> x, y;
  for (const Step& s : steps) {
    const Units expected = predictor.predict(s.from);
    predictor.observe(s.to);
    x.push_back(folded(s.to.x - expected.x));
    y.push_back(folded(s.to.y - expected.y));
  }
  out.put_list(x, kResidualBits);
  out.put_list(y, kResidualBits);
}

void put_fresh_places(BitWriter& out, const CodedTracks& fresh) {
  if (fresh.empty()) return;
  Units low = fresh.front().at, high = low;
  for (const CodedTrack& t : fresh) {
    low = {std::min(low.x, t.at.x), std::min(low.y, t.at.y)};
    high = {std::max(high.x, t.at.x), std::max(high.y, t.at.y)};
  }
  const auto width = static_cast<std::uint32_t>(high.x - low.x), height = static_cast<std::uint32_t>(high.y - low.y);
  out.put(static_cast<std::uint16_t>(low.x), kUnitBits);
  out.put(static_cast<std::uint16_t>(low.y), kUnitBits);
  out.put(width, kUnitBits);
  out.put(height, kUnitBits);
  for (const CodedTrack& t : fresh) {
    out.put_below(static_cast<std::uint32_t>(t.at.x - low.x), width + 1);
    out.put_below(static_cast<std::uint32_t>(t.at.y - low.y), height + 1);
  }
}

Problem get_kept_ids(BitReader& in, const CodedTracks& reference, std::vector<Kept>& kept_tracks) {
  const std::size_t missing = in.get(kCountBits);
  if (missing > reference.size()) return Rejection::kTooMany;
  std::size_t next = 0;
  const auto keep = [&] {
    kept_tracks.push_back({reference[next].track, {reference[next].at, {}}});
    ++next;
  };
  if (missing > 0) {
    for (const std::uint32_t step : in.get_list(missing, kCountBits)) {
      if (step >= reference.size() - next) return Rejection::kMalformed;
      for (std::uint32_t i = 0; i < step; ++i) keep();
      ++next;
    }
  }
  while (next < reference.size()) keep();
  return in.ok() ? std::nullopt : Problem(Rejection::kMalformed);
}

Problem get_fresh_ids(BitReader& in, std::uint32_t above, CodedTracks& fresh) {
  if (fresh.empty()) return std::nullopt;
  std::uint32_t before = in.get(1) == 1 ? above : 0;
  const std::vector<std::uint32_t> steps = in.get_list(fresh.size(), kIdBits);
  if (!in.ok()) return Rejection::kMalformed;
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    if (steps[i] >= std::numeric_limits<std::uint32_t>::max() - before) return Rejection::kIdsNotAscending;
    fresh[i].track = before += steps[i] + 1;
  }
  return std::nullopt;
}

bool within_limits(Units at) { return std::max(std::abs(at.x), std::abs(at.y)) <= kMostUnits; }

Problem get_kept_places(BitReader& in, std::vector<Kept>& kept_tracks) {
  if (kept_tracks.empty()) return std::nullopt;
  MotionParameters parameters;
  for (std::int16_t& p : parameters) p = static_cast<std::int16_t>(in.get(kUnitBits));
  const std::vector<std::uint32_t> x = in.get_list(kept_tracks.size(), kResidualBits);
  const std::vector<std::uint32_t> y = in.get_list(kept_tracks.size(), kResidualBits);
  if (!in.ok()) return Rejection::kMalformed;
  TrackPredictor predictor(CommonMotion(centre_of(kept_tracks), parameters), kept_tracks.size());
  for (std::size_t i = 0; i < kept_tracks.size(); ++i) {
    const Units expected = predictor.predict(kept_tracks[i].step.from);
    kept_tracks[i].step.to = {expected.x + unfolded(x[i]), expected.y + unfolded(y[i])};
    if (!within_limits(kept_tracks[i].step.to)) return Rejection::kOutOfRange;
    predictor.observe(kept_tracks[i].step.to);
  }
  return std::nullopt;
}

Problem get_fresh_places(BitReader& in, CodedTracks& fresh) {
  if (fresh.empty()) return std::nullopt;
  const auto low_x = static_cast<std::int16_t>(in.get(kUnitBits)), low_y = static_cast<std::int16_t>(in.get(kUnitBits));
  const std::uint32_t width = in.get(kUnitBits), height = in.get(kUnitBits);
  for (CodedTrack& t : fresh) {
    t.at.x = low_x + static_cast<std::int32_t>(in.get_below(width + 1));
    t.at.y = low_y + static_cast<std::int32_t>(in.get_below(height + 1));
    if (!within_limits(t.at)) return Rejection::kOutOfRange;
  }
  return in.ok() ? std::nullopt : Problem(Rejection::kMalformed);
}

}  // namespace

std::vector<std::uint8_t> pack_tracks(const CodedTracks& tracks, const CodedTracks& reference) {
  const Split s = split(tracks, reference);
  BitWriter out;
  if (!reference.empty()) put_missing(out, s.missing);
  put_fresh_ids(out, s.fresh, last_of(reference));
  put_kept(out, s.kept_tracks);
  put_fresh_places(out, s.fresh);
  return out.take();
}

Problem unpack_tracks(std::span<const std::uint8_t> octets, std::size_t count, const CodedTracks& reference,
                      CodedTracks& tracks) {
  BitReader in(octets);
  std::vector<Kept> kept_tracks;
  if (!reference.empty()) {
    if (const Problem p = get_kept_ids(in, reference, kept_tracks)) return p;
  }
  if (kept_tracks.size() > count) return Rejection::kSizeMismatch;
  CodedTracks fresh(count - kept_tracks.size());
  if (const Problem p = get_fresh_ids(in, last_of(reference), fresh)) return p;
  if (const Problem p = get_kept_places(in, kept_tracks)) return p;
  if (const Problem p = get_fresh_places(in, fresh)) return p;
  if (!in.at_end()) return Rejection::kMalformed;
  CodedTracks carried;
  for (const Kept& k : kept_tracks) carried.push_back({k.track, k.step.to});
  tracks.reserve(count);
  std::ranges::merge(carried, fresh, std::back_inserter(tracks), {}, &CodedTrack::track, &CodedTrack::track);
  const auto repeated = std::ranges::adjacent_find(tracks, {}, &CodedTrack::track);
  return repeated == tracks.end() ? std::nullopt : Problem(Rejection::kIdsNotAscending);
}

}  // namespace coslam
