// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>
#include <vector>

#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/geometry/rigid3.h"

namespace coslam {

// Hash of a value by all of its kept fields, to detect changes: two values that differ have the same hash by chance
// alone.
class Fingerprint {
 public:
  std::uint64_t value() const { return state_; }

  template <class T>
  requires std::is_arithmetic_v<T>
  void add(T v) {
    if constexpr (std::floating_point<T>) {
      mix(std::bit_cast<std::uint64_t>(static_cast<double>(v)));
    } else {
      mix(static_cast<std::uint64_t>(v));
    }
  }
  template <class T>
  requires std::is_enum_v<T>
  void add(T v) { add(static_cast<std::underlying_type_t<T>>(v)); }
  template <class Tag, class Rep>
  void add(Id<Tag, Rep> id) {
    add(id.value);
  }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) add(m.derived().coeff(i));
  }
  void add(const Rigid3& v) {
    add(v.rotation.coeffs());
    add(v.translation);
  }
  template <std::size_t kSize>
  void add(const std::array<std::uint8_t, kSize>& octets) {
    for (std::size_t i = 0; i < kSize; i += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, octets.data() + i, std::min(sizeof word, kSize - i));
      mix(word);
    }
  }
  template <class T>
  void add(const std::optional<T>& v) {
    add(v.has_value());
    if (v) add(*v);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    mix(values.size());
    for (const T& v : values) add(v);
  }
  template <HasFields T>
  void add(const T& value) {
    each_kept_field(value, [this](const auto& field) { add(field.value); });
  }

 private:
  void mix(std::uint64_t v) {
    state_ = (state_ ^ v) * 0x9e3779b97f4a7c15U;
    state_ ^= state_ >> 29U;
  }
  std::uint64_t state_ = 1;
};

template <class T>
std::uint64_t fingerprint(const T& value) {
  Fingerprint f;
  f.add(value);
  return f.value();
}

}  // namespace coslam
