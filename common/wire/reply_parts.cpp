// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/wire/reply_parts.h"

#include <algorithm>
#include <utility>

#include "idl/coslam.h"

namespace coslam {
namespace {

// The tracks [from, to) of an answer.
PatchReply cut(const PatchReply& reply, std::size_t from, std::size_t to) {
  const auto at = [&](std::size_t i) { return reply.patches.begin() + static_cast<std::ptrdiff_t>(i); };
  return {reply.agent, reply.agent_run, reply.frame, {at(from), at(to)}, {}};
}

DescriptorReply cut(const DescriptorReply& reply, std::size_t from, std::size_t to) {
  const auto track = [&](std::size_t i) { return reply.tracks.begin() + static_cast<std::ptrdiff_t>(i); };
  const auto value = [&](std::size_t i) {
    return reply.descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDescriptorBytes);
  };
  return {reply.agent, reply.agent_run, reply.frame, {track(from), track(to)}, {value(from), value(to)}, {}};
}

std::size_t tracks_of(const PatchReply& reply) { return reply.patches.size(); }
std::size_t tracks_of(const DescriptorReply& reply) { return reply.tracks.size(); }

template <class Value>
void append(std::vector<Value>& to, const std::vector<Value>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append(PatchReply& whole, const PatchReply& part) { append(whole.patches, part.patches); }

void append(DescriptorReply& whole, const DescriptorReply& part) {
  append(whole.tracks, part.tracks);
  append(whole.descriptors, part.descriptors);
}

bool in_order(const PatchReply&) { return true; }
bool in_order(const DescriptorReply& reply) {
  return std::ranges::adjacent_find(reply.tracks, std::greater_equal<>()) == reply.tracks.end();
}

template <class Reply>
std::vector<Reply> all_parts(const Reply& reply) {
  const std::size_t count = tracks_of(reply);
  const auto parts = static_cast<std::uint16_t>(std::max<std::size_t>(1, (count + idl::MAX_PART - 1) / idl::MAX_PART));
  std::vector<Reply> out;
  for (std::uint16_t n = 0; n < parts; ++n) {
    const std::size_t from = n * std::size_t{idl::MAX_PART};
    out.push_back(cut(reply, from, std::min(count, from + idl::MAX_PART)));
    out.back().part = {n, parts};
  }
  return out;
}

}  // namespace

std::vector<PatchReply> in_parts(const PatchReply& reply) { return all_parts(reply); }
std::vector<DescriptorReply> in_parts(const DescriptorReply& reply) { return all_parts(reply); }

template <class Reply>
std::optional<Rejection> PartJoiner<Reply>::add(Reply part) {
  auto found = std::ranges::find(gathered_, part.frame, &Gathered::frame);
  std::optional<Rejection> reason;
  if (found == gathered_.end()) {
    if (gathered_.size() == bound_) {
      gathered_.pop_front();
      reason = Rejection::kOverflow;
    }
    gathered_.push_back({part.frame, std::vector<std::optional<Reply>>(part.part.count), part.part.count});
    found = std::prev(gathered_.end());
  }
  if (found->parts.size() != part.part.count) return Rejection::kSizeMismatch;
  std::optional<Reply>& place = found->parts[part.part.number];
  if (place) return Rejection::kDuplicate;
  place = std::move(part);
  --found->missing;
  return reason;
}

template <class Reply>
bool PartJoiner<Reply>::has(FrameId frame) const {
  return std::ranges::any_of(gathered_, [&](const Gathered& g) { return g.frame == frame && g.missing == 0; });
}

template <class Reply>
std::optional<FrameId> PartJoiner<Reply>::oldest_complete() const {
  std::optional<FrameId> oldest;
  for (const Gathered& g : gathered_) {
    if (g.missing == 0 && (!oldest || g.frame < *oldest)) oldest = g.frame;
  }
  return oldest;
}

template <class Reply>
std::optional<Reply> PartJoiner<Reply>::take(FrameId frame) {
  const auto found = std::ranges::find(gathered_, frame, &Gathered::frame);
  if (found == gathered_.end() || found->missing != 0) return std::nullopt;
  Reply whole = std::move(*found->parts.front());
  whole.part = {};
  for (std::size_t i = 1; i < found->parts.size(); ++i) append(whole, *found->parts[i]);
  gathered_.erase(found);
  if (!in_order(whole)) return std::nullopt;
  return whole;
}

template <class Reply>
Decoded<Reply> in_one(std::vector<Reply> parts) {
  PartJoiner<Reply> joiner(1);
  const FrameId frame = parts.front().frame;
  const std::pair sender(parts.front().agent, parts.front().agent_run);
  for (Reply& part : parts) {
    if (std::pair(part.agent, part.agent_run) != sender) return Rejection::kWrongRun;
    if (const auto reason = joiner.add(std::move(part))) return *reason;
  }
  auto whole = joiner.take(frame);
  if (!whole) return Rejection::kSizeMismatch;
  return std::move(*whole);
}

template Decoded<PatchReply> in_one(std::vector<PatchReply> parts);
template Decoded<DescriptorReply> in_one(std::vector<DescriptorReply> parts);
template class PartJoiner<PatchReply>;
template class PartJoiner<DescriptorReply>;

}  // namespace coslam
