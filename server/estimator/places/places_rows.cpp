// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the places outlive their server by.
#include <utility>

#include "server/estimator/map/serialise.h"
#include "server/estimator/places/place_recognition.h"

namespace coslam {
namespace {

constexpr int kMostSkipped = 1 << 24;  // images that were forgotten in succession

}  // namespace

void KeyImageDatabase::save(std::vector<Row>* rows) {
  for (const int number : std::exchange(forgotten_, {})) rows->push_back({"place", number, {}});
  for (auto at = images_.lower_bound(saved_); at != images_.end(); ++at) {
    rows->push_back({"place", at->first, octets_of(at->second)});
  }
  saved_ = index_.size();
}

void KeyImageDatabase::restore(const Tables& tables) {
  const auto table = tables.find("place");
  if (table == tables.end()) return;
  for (const auto& [key, octets] : table->second) {
    KeyImage image;
    read_octets(octets, image);
    const int skipped = static_cast<int>(key) - index_.size();
    if (skipped < 0 || skipped > kMostSkipped) throw UserError("the map file has a place of no number");
    index_.skip(skipped);
    index_.add(image.descriptors);
    images_[static_cast<int>(key)] = std::move(image);
  }
}

void PlaceRecognition::save(std::vector<Row>* rows) {
  places_.save(rows);
  rows->push_back({"state", static_cast<std::int64_t>(StateRow::kMeetings), octets_of(loops_)});
}

void PlaceRecognition::restore(const Tables& tables) {
  places_.restore(tables);
  read_state(tables, StateRow::kMeetings, loops_);
}

}  // namespace coslam
