// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/base/fields.h"
#include "common/base/flat_map.h"
#include "common/geometry/rigid3.h"
#include "server/estimator/map/map.h"

namespace coslam::test {

// kKept: what a map file has of them; else all.
enum class Compared { kKept, kAll };

// Where two values differ first, as the path of fields to it; empty: nowhere.
class Difference {
 public:
  explicit Difference(Compared compared = Compared::kAll) : compared_(compared) {}

  template <HasFields T>
  std::string of(const T& a, const T& b) const {
    std::string found;
    std::apply(
        [&](const auto&... of_a) {
          std::apply([&](const auto&... of_b) { (add(of_a, of_b, &found), ...); }, fields(b));
        },
        fields(a));
    return found;
  }
  std::string of(const Map& a, const Map& b) const {
    std::string found;
    const auto note = [&](const char* name, const auto& x, const auto& y) {
      if (found.empty()) found = named(name, of(x, y));
    };
    note("cameras", a.cameras(), b.cameras());
    note("points", a.points(), b.points());
    note("motions", a.motions(), b.motions());
    note("key_frames", a.key_frames(), b.key_frames());
    note("key_images", a.key_images(), b.key_images());
    note("skipped_key_images", a.skipped_key_images(), b.skipped_key_images());
    note("untracked_points", a.untracked_points(), b.untracked_points());
    note("moves", a.moves(), b.moves());
    note("shifted_ns", a.shifted_ns(), b.shifted_ns());
    note("epoch", a.epoch(), b.epoch());
    note("now", a.now(), b.now());
    note("now_ns", a.now_ns(), b.now_ns());
    note("next_map", a.next_map(), b.next_map());
    note("set_interval_s", a.set_interval_s(), b.set_interval_s());
    if (compared_ == Compared::kKept && found.empty()) {
      for (std::size_t i = 0; i < a.cameras().size(); ++i) note("frames", a.cameras()[i].frames, b.cameras()[i].frames);
    }
    return found;
  }

 private:
  static std::string named(const std::string& name, const std::string& found) {
    return found.empty() ? "" : name + (found.front() == '[' ? "" : ".") + found;
  }

  template <class A, class B>
  void add(const A& of_a, const B& of_b, std::string* found) const {
    if (!found->empty() || (compared_ == Compared::kKept && !A::kIsKept)) return;
    *found = named(of_a.name, of(of_a.value, of_b.value));
  }
  std::string of(const Rigid3& a, const Rigid3& b) const {
    const bool same = a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
    return same ? "" : "differs";
  }
  std::string of(const Similarity3& a, const Similarity3& b) const {
    const bool same =
        a.scale == b.scale && a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
    return same ? "" : "differs";
  }
  template <class A, class B>
  std::string of(const std::pair<A, B>& a, const std::pair<A, B>& b) const {
    const std::string first = of(a.first, b.first);
    return first.empty() ? of(a.second, b.second) : "key." + first;
  }
  template <class T>
  std::string of(const std::optional<T>& a, const std::optional<T>& b) const {
    if (a.has_value() != b.has_value()) return "differs";
    return a ? of(*a, *b) : "";
  }
  template <class T>
  std::string of(const std::vector<T>& a, const std::vector<T>& b) const {
    return each(a, b);
  }
  template <class T>
  std::string of(const std::deque<T>& a, const std::deque<T>& b) const {
    return each(a, b);
  }
  template <class Key, class Value>
  std::string of(const std::map<Key, Value>& a, const std::map<Key, Value>& b) const {
    return each(a, b);
  }
  template <class Key, class Value>
  std::string of(const FlatMap<Key, Value>& a, const FlatMap<Key, Value>& b) const {
    return each(a, b);
  }
  template <class T>
  std::string of(const T& a, const T& b) const {
    return a == b ? "" : "differs";
  }

  template <class All>
  std::string each(const All& a, const All& b) const {
    if (a.size() != b.size()) return "size differs";
    auto y = b.begin();
    std::size_t i = 0;
    for (auto x = a.begin(); x != a.end(); ++x, ++y, ++i) {
      const std::string found = of(*x, *y);
      if (!found.empty()) return named("[" + std::to_string(i) + "]", found);
    }
    return "";
  }

  Compared compared_;
};

}  // namespace coslam::test
