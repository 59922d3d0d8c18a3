// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the scale outlives its server by.
#include "server/estimator/adjust/scale.h"
#include "server/estimator/map/serialise.h"

namespace coslam {

template <class A>
void TagScale::serialize(A& a) {
  a(seen_, twice_, reported_, states_);
}
template <class A>
void TagScale::TagSighting::serialize(A& a) {
  a(camera, set, calibrated_px);
}
template <class A>
void TagScale::State::serialize(A& a) {
  a(in_metres, sigma, doubted, tags);
}

void Scale::save(std::vector<Row>* rows) const {
  rows->push_back(
      {"state", static_cast<std::int64_t>(StateRow::kScale), octets_of(tags_, metric_, scaled_, scaled_at_)});
}

void Scale::restore(const Tables& tables) { read_state(tables, StateRow::kScale, tags_, metric_, scaled_, scaled_at_); }

}  // namespace coslam
