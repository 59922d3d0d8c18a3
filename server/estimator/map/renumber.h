// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/base/time.h"

namespace coslam {

// How what came from another map is numbered here. Ids that an agent gave stay: they are scoped by its camera.
struct Renumbered {
  std::uint16_t cameras = 0;
  std::uint32_t points = 0, maps = 0, sets = 0;
  TimeNs later_ns = 0;
  std::uint64_t moves = 0;  // of Map::moves(), before those of the other map
  TimeNs shifted_ns = 0;    // to be added to the other's ArchivedPlace::shifted_ns

  CameraId of(CameraId id) const { return CameraId(static_cast<std::uint16_t>(id.value + cameras)); }
  PointId of(PointId id) const { return id == PointId() ? id : PointId(id.value + points); }
  MapId of(MapId id) const { return id == MapId() ? id : MapId(id.value + maps); }
  SetId of(SetId id) const { return SetId(id.value + sets); }
};

// Gives everything in a value its number here, by the types of its fields; instants move by later_ns.
class Renumber {
 public:
  explicit Renumber(const Renumbered& as) : as_(as) {}

  template <class T>
  void apply(T& value) const {
    if constexpr (requires { as_.of(value); }) {
      value = as_.of(value);
    } else if constexpr (HasFields<T>) {
      each_field(value, [this](const auto& field) {
        if constexpr (std::remove_cvref_t<decltype(field)>::kIsInstant) {
          shift(field.value);
        } else {
          apply(field.value);
        }
      });
    }  // else: a figure
  }
  template <class T>
  void apply(std::vector<T>& values) const {
    for (T& v : values) apply(v);
  }
  template <class Key, class Value>
  void apply(std::map<Key, Value>& values) const {
    std::map<Key, Value> out;
    for (auto& [key, value] : values) {
      Key as = key;
      apply(as);
      apply(value);
      out.emplace(as, std::move(value));
    }
    values = std::move(out);
  }

 private:
  void shift(TimeNs& t_ns) const { t_ns += as_.later_ns; }
  template <class T>
  void shift(std::vector<T>& values) const {
    for (T& v : values) shift(v);
  }
  void shift(std::pair<TimeNs, TimeNs>& span) const {
    shift(span.first);
    shift(span.second);
  }

  const Renumbered& as_;
};

}  // namespace coslam
