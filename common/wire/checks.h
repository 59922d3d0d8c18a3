// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "common/geometry/rigid3.h"
#include "common/wire/codec.h"

// Checks of values for decoders. Each returns the first problem, or nothing. For the codec only.
namespace coslam {

using Problem = std::optional<Rejection>;

constexpr double kFarthest = 1e9;  // metres or map units; beyond it, float positions have lost all meaning

template <class T>
Problem check_number(T value, double low, double high) {
  if (!std::isfinite(value)) return Rejection::kNotFinite;
  if (!(value >= low && value <= high)) return Rejection::kOutOfRange;
  return std::nullopt;
}

template <class Vector>
Problem check_position(const Vector& position) {
  if (!position.allFinite()) return Rejection::kNotFinite;
  if (!(position.cwiseAbs().maxCoeff() <= kFarthest)) return Rejection::kOutOfRange;
  return std::nullopt;
}

// Packed xx xy xz yy yz zz.
template <class Packed>
Problem check_covariance(const Packed& packed) {
  if (!packed.allFinite()) return Rejection::kNotFinite;
  if (!(packed[0] >= 0 && packed[3] >= 0 && packed[5] >= 0)) return Rejection::kOutOfRange;
  return std::nullopt;
}

// Unit norm up to the rounding that products of rotations gather.
inline Problem check_rotation(const Eigen::Quaterniond& q) {
  if (!q.coeffs().allFinite()) return Rejection::kNotFinite;
  if (!(std::abs(q.squaredNorm() - 1.0) <= 1e-6)) return Rejection::kBadRotation;
  return std::nullopt;
}

inline Problem check_pose(const Rigid3& pose) {
  if (const Problem p = check_rotation(pose.rotation)) return p;
  return check_position(pose.translation);
}

template <class Enum>
Problem check_enum(std::uint8_t value, Enum last) {
  return value <= static_cast<std::uint8_t>(last) ? std::nullopt : Problem(Rejection::kOutOfRange);
}

template <class Id>
Problem check_id(Id id) {
  return id.value != 0 ? std::nullopt : Problem(Rejection::kBadId);
}

inline Problem check_count(std::size_t count, std::size_t bound) {
  return count <= bound ? std::nullopt : Problem(Rejection::kTooMany);
}

inline Problem check_name(std::string_view name) {
  return valid_agent_name(name) ? std::nullopt : Problem(Rejection::kBadText);
}

// A sender: a name and a run.
inline Problem check_sender(std::string_view agent, RunId run) {
  if (const Problem p = check_name(agent)) return p;
  return check_id(run);
}

// Text that goes into a log or onto a terminal.
inline Problem check_sentence(std::string_view text, std::size_t most) {
  const auto control_character = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  const bool good = !text.empty() && text.size() <= most && std::ranges::none_of(text, control_character);
  return good ? std::nullopt : Problem(Rejection::kBadText);
}

// The first problem of several checks, all of them cheap.
inline Problem first_of(std::initializer_list<Problem> problems) {
  for (const Problem& p : problems) {
    if (p) return p;
  }
  return std::nullopt;
}

}  // namespace coslam
