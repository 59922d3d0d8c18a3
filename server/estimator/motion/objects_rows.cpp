// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the objects outlive their server by.
#include "server/estimator/map/serialise.h"
#include "server/estimator/motion/objects.h"

namespace coslam {

void Objects::save(std::vector<Row>* rows) const {
  rows->push_back({"state", static_cast<std::int64_t>(StateRow::kObjects), octets_of(next_object_)});
}

void Objects::restore(const Tables& tables) { read_state(tables, StateRow::kObjects, next_object_); }

}  // namespace coslam
