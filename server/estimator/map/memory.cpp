// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/estimator/map/memory.h"

#include <string_view>

#include "common/base/fields.h"

namespace coslam {
namespace {

// Adds up what vectors hold, by what it is kept for: some fields have a use of their own, the others that of what they
// are part of.
class Owned {
 public:
  explicit Owned(MemoryUse* use) : use_(*use) {}

  template <HasFields T>
  void add(const T& value, std::string_view purpose) {
    each_field(value, [&](const auto& field) { add(field.value, use_of(field.name, purpose)); });
  }
  template <class T>
  void add(const std::vector<T>& values, std::string_view purpose) {
    count(purpose, bytes_of(values));
    if constexpr (HasFields<T>) {
      for (const T& v : values) add(v, purpose);
    }
  }
  template <class Key, class Value>
  void add(const FlatMap<Key, Value>& values, std::string_view purpose) {
    for (const auto& [key, value] : values) add_one(value, purpose);
  }
  template <class T>
  void add_one(const T& value, std::string_view purpose) {
    count(purpose, sizeof value);
    add(value, purpose);
  }
  template <class T>
  void add(const T&, std::string_view) {}  // holds nothing

 private:
  static std::string_view use_of(std::string_view field, std::string_view within) {
    if (field == "frames") return "poses";
    if (field == "held") return "held_tracks";
    for (const std::string_view known_purpose : {"tracks", "key_observations", "patches"}) {
      if (field == known_purpose) return known_purpose;
    }
    return within;
  }
  void count(std::string_view purpose, std::size_t bytes) { use_[std::string(purpose)] += bytes; }

  MemoryUse& use_;
};

}  // namespace

MemoryUse memory_of(const Map& map) {
  MemoryUse use{{"poses", 0},   {"held_tracks", 0}, {"tracks", 0}, {"points", 0}, {"key_observations", 0},
                {"patches", 0}, {"paths", 0}};
  Owned owned(&use);
  for (const MapCamera& c : map.cameras()) owned.add(c, "poses");
  for (const auto& [id, p] : map.points()) owned.add_one(p, "points");
  for (const auto& [id, samples] : map.motions()) owned.add(samples, "paths");
  return use;
}

}  // namespace coslam
