// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the places outlive their server by.
#include "server/map/serialise.h"
#include "server/places/meet.h"

namespace coslam {

template <class A>
void serialize(A& a, KeyImage& v) {
  a(v.set, v.camera, v.tracks, v.descriptors);
}
template <class A>
void serialize(A& a, LoopConstraint& v) {
  a(v.camera, v.to_camera, v.set, v.to_set, v.camera_from_to, v.scale);
}

void PlaceMemory::save(std::vector<Row>* rows) {
  for (; saved_ < images_.size(); ++saved_) {
    rows->push_back({"place", static_cast<std::int64_t>(saved_), octets_of(images_[saved_])});
  }
}

void PlaceMemory::restore(const Tables& tables) {
  const auto table = tables.find("place");
  if (table == tables.end()) return;
  for (const auto& [key, octets] : table->second) {
    KeyImage image;
    read_octets(octets, image);
    index_.add(image.descriptors);
    images_.push_back(std::move(image));
  }
}

void Meetings::save(std::vector<Row>* rows) {
  places_.save(rows);
  rows->push_back({"state", static_cast<std::int64_t>(StateRow::kMeetings), octets_of(loops_)});
}

void Meetings::restore(const Tables& tables) {
  places_.restore(tables);
  read_state(tables, StateRow::kMeetings, loops_);
}

}  // namespace coslam
