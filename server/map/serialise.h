// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/set.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/vector.hpp>
#include <sstream>
#include <string>
#include <tuple>

#include "common/base/error.h"
#include "common/base/ids.h"
#include "common/geometry/rigid3.h"
#include "server/map/rows.h"

// Values as octets, for the map file; little endian. What is read was written by write_octets() and came through a
// check sum. For the few sources that save something: the header is heavy.
namespace Eigen {

template <class Archive, class Scalar, int kRows, int kCols, int kOptions>
void serialize(Archive& archive, Matrix<Scalar, kRows, kCols, kOptions, kRows, kCols>& m) {
  static_assert(kRows > 0 && kCols > 0, "of fixed size");
  archive(cereal::binary_data(m.data(), sizeof(Scalar) * kRows * kCols));
}

template <class Archive>
void serialize(Archive& archive, Quaterniond& q) {
  archive(q.coeffs());
}

}  // namespace Eigen

namespace coslam {

template <class Archive, class Tag, class Rep>
void serialize(Archive& archive, Id<Tag, Rep>& id) {
  archive(id.value);
}

template <class Archive>
void serialize(Archive& archive, Rigid3& v) {
  archive(v.rotation, v.translation);
}

template <class Archive>
void serialize(Archive& archive, Similarity3& v) {
  archive(v.scale, v.rotation, v.translation);
}

template <class... Values>
std::string octets_of(const Values&... values) {
  std::ostringstream out(std::ios::binary);
  cereal::BinaryOutputArchive archive(out);
  archive(values...);
  return std::move(out).str();
}

// Throws UserError when they are not what they should be.
template <class... Values>
void read_octets(const std::string& octets, Values&... values) {
  std::istringstream in(octets, std::ios::binary);
  try {
    cereal::BinaryInputArchive archive(in);
    archive(values...);
  } catch (const std::exception&) {
    throw UserError("a row of the map file is not what it should be");
  }
}

// The same of a row of "state"; values stay as they are when there is none.
template <class... Values>
void read_state(const Tables& tables, StateRow row, Values&... values) {
  const auto table = tables.find("state");
  if (table == tables.end()) return;
  const auto at = table->second.find(static_cast<std::int64_t>(row));
  if (at != table->second.end()) read_octets(at->second, values...);
}

}  // namespace coslam
