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

// Offsets by which ids and times of another map are renumbered in this one. Ids that an agent gave stay: they are
// scoped by its camera.
struct Renumbered {
  std::uint16_t cameras = 0;
  std::uint32_t points = 0, maps = 0, sets = 0;
  TimeNs later_ns = 0;
  std::uint64_t moves = 0;  // added to the other map's numbers of Map::moves()
  TimeNs shifted_ns = 0;    // added to the other map's ArchivedPlace::shifted_ns

  CameraId new_id(CameraId id) const { return CameraId(static_cast<std::uint16_t>(id.value + cameras)); }
  PointId new_id(PointId id) const { return id == PointId() ? id : PointId(id.value + points); }
  MapId new_id(MapId id) const { return id == MapId() ? id : MapId(id.value + maps); }
  SetId new_id(SetId id) const { return SetId(id.value + sets); }
};

// Renumbers all ids in a value, by the types of its fields; instants move by later_ns.
class Renumber {
 public:
  explicit Renumber(const Renumbered& renumbered) : renumbered_(renumbered) {}

  template <class T>
  void apply(T& value) const {
    if constexpr (requires { renumbered_.new_id(value); }) {
      value = renumbered_.new_id(value);
    } else if constexpr (HasFields<T>) {
      each_field(value, [this](const auto& field) {
        if constexpr (std::remove_cvref_t<decltype(field)>::kIsInstant) {
          shift(field.value);
        } else {
          apply(field.value);
        }
      });
    }  // other types hold no ids
  }
  template <class T>
  void apply(std::vector<T>& values) const {
    for (T& v : values) apply(v);
  }
  template <class Key, class Value>
  void apply(std::map<Key, Value>& values) const {
    std::map<Key, Value> out;
    for (auto& [key, value] : values) {
      Key new_key = key;
      apply(new_key);
      apply(value);
      out.emplace(new_key, std::move(value));
    }
    values = std::move(out);
  }

 private:
  void shift(TimeNs& t_ns) const { t_ns += renumbered_.later_ns; }
  template <class T>
  void shift(std::vector<T>& values) const {
    for (T& v : values) shift(v);
  }
  void shift(std::pair<TimeNs, TimeNs>& span) const {
    shift(span.first);
    shift(span.second);
  }

  const Renumbered& renumbered_;
};

}  // namespace coslam
