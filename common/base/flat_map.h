// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/container/flat_map.hpp>
#include <functional>
#include <utility>
#include <vector>

namespace coslam {

// A map that lies in memory as it is walked through. What is added or erased moves what comes after it, and pointers
// to values hold only until then: for what is read far more often than changed, or grows at its end.
template <class Key, class Value>
using FlatMap = boost::container::flat_map<Key, Value, std::less<Key>, std::vector<std::pair<Key, Value>>>;

// Removes the entries for which holds(entry) is true.
template <class Key, class Value>
void erase_if(FlatMap<Key, Value>* map, auto&& holds) {
  auto all = map->extract_sequence();
  std::erase_if(all, holds);
  map->adopt_sequence(boost::container::ordered_unique_range, std::move(all));
}

}  // namespace coslam
