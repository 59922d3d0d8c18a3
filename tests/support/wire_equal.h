// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/geometry/rigid3.h"
#include "common/model/map_patch.h"
#include "common/model/session.h"
#include "tests/support/members.h"

// Equality bit for bit of what crosses the wire, whatever its type: member by member.
namespace coslam::test {

template <class T>
constexpr bool kIsArray = false;
template <class T, std::size_t kSize>
constexpr bool kIsArray<std::array<T, kSize>> = true;

// Place where two values differ first, as the numbers of the members on the way to it; empty: they are equal.
class BitDifference {
 public:
  template <class T>
  std::string between(const T& a, const T& b) const {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      return same_bits(&a, &b, sizeof(T));  // floating point: -0 is not 0, and a NaN is itself
    } else if constexpr (std::is_aggregate_v<T> && std::is_class_v<T> && !kIsArray<T>) {
      return first(members(a), members(b), std::make_index_sequence<std::tuple_size_v<decltype(members(a))>>());
    } else {
      return a == b ? "" : "differs";
    }
  }
  template <class Scalar, int kRows, int kCols>
  std::string between(const Eigen::Matrix<Scalar, kRows, kCols>& a,
                      const Eigen::Matrix<Scalar, kRows, kCols>& b) const {
    return same_bits(a.data(), b.data(), sizeof(Scalar) * static_cast<std::size_t>(a.size()));
  }
  std::string between(const Rigid3& a, const Rigid3& b) const {
    return first(std::tie(a.rotation.coeffs(), a.translation), std::tie(b.rotation.coeffs(), b.translation),
                 std::make_index_sequence<2>());
  }
  std::string between(const Similarity3& a, const Similarity3& b) const {
    return first(std::tie(a.scale, a.rotation.coeffs(), a.translation),
                 std::tie(b.scale, b.rotation.coeffs(), b.translation), std::make_index_sequence<3>());
  }
  template <class T>
  std::string between(const std::optional<T>& a, const std::optional<T>& b) const {
    if (a.has_value() != b.has_value()) return "differs";
    return a ? between(*a, *b) : "";
  }
  template <class T>
  std::string between(const std::vector<T>& a, const std::vector<T>& b) const {
    return each(a, b);
  }
  template <class T, std::size_t kSize>
  std::string between(const std::array<T, kSize>& a, const std::array<T, kSize>& b) const {
    return each(a, b);
  }
  std::string between(MapPatch a, MapPatch b) const {
    a.received_ns = b.received_ns = 0;  // not on the wire
    return between<MapPatch>(a, b);
  }
  std::string between(AgentStatus a, AgentStatus b) const {
    a.exchange.arrived_ns = b.exchange.arrived_ns = 0;  // not on the wire
    return between<AgentStatus>(a, b);
  }

 private:
  static std::string same_bits(const void* a, const void* b, std::size_t size) {
    return std::memcmp(a, b, size) == 0 ? "" : "differs";
  }

  template <class Tuple, std::size_t... kIndices>
  std::string first(const Tuple& a, const Tuple& b, std::index_sequence<kIndices...>) const {
    std::string found;
    ((found.empty() ? void(found = at(kIndices, between(std::get<kIndices>(a), std::get<kIndices>(b)))) : void()), ...);
    return found;
  }

  template <class All>
  std::string each(const All& a, const All& b) const {
    if (a.size() != b.size()) return "differs in size";
    std::string found;
    for (std::size_t i = 0; i < a.size() && found.empty(); ++i) found = at(i, between(a[i], b[i]));
    return found;
  }

  static std::string at(std::size_t index, const std::string& found) {
    return found.empty() ? "" : "[" + std::to_string(index) + "]" + (found[0] == '[' ? "" : " ") + found;
  }
};

template <class T>
void expect_same(const T& a, const T& b) {
  EXPECT_EQ(BitDifference().between(a, b), "");
}

}  // namespace coslam::test
