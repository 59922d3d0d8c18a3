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
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "common/base/error.h"
#include "common/base/fields.h"
#include "common/base/ids.h"
#include "common/geometry/camera_model.h"
#include "common/geometry/lens_correction.h"
#include "common/geometry/rigid3.h"
#include "server/estimator/map/rows.h"

// Serialisation of values to octets for the map file; little endian. Input passed a check sum, which anybody can make:
// no count in it is trusted. The header is heavy, so only the few sources that save something include it.
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
void serialize(Archive& archive, CameraModel& v) {
  archive(v.width_px, v.height_px, v.fx, v.fy, v.cx, v.cy, v.distortion, v.coefficients);
}

template <class Archive>
void serialize(Archive& archive, LensCorrection& v) {
  archive(v.values);
}

template <class Archive>
void serialize(Archive& archive, Rigid3& v) {
  archive(v.rotation, v.translation);
}

template <class Archive>
void serialize(Archive& archive, Similarity3& v) {
  archive(v.scale, v.rotation, v.translation);
}

// Reads what BinaryOutputArchive wrote, and trusts no count: every counted element takes at least one octet.
class OctetArchive : public cereal::InputArchive<OctetArchive, cereal::AllowEmptyClassElision> {
 public:
  // version: of the rows, see kRowsVersion.
  explicit OctetArchive(std::string_view octets, int version = kRowsVersion)
      : InputArchive(this), left_(octets), version_(version) {}
  int version() const { return version_; }

  void loadBinary(void* to, std::size_t size) {  // NOLINT(readability-identifier-naming): cereal's
    check_room(size);
    if (size == 0) return;  // `to` may be null then
    std::memcpy(to, left_.data(), size);
    left_.remove_prefix(size);
  }
  void check_room(std::uint64_t count) const {
    if (count > left_.size()) throw cereal::Exception("the octets end");
  }

 private:
  std::string_view left_;
  int version_;
};

// Serialises a struct as its kept fields, one after the other.
template <class Archive, HasFields T>
void serialize(Archive& archive, T& value) {
  int version = kRowsVersion;
  if constexpr (requires { archive.version(); }) version = archive.version();
  each_kept_field(value, [&](const auto& field) {
    if (field.since <= version) archive(field.value);
  });
}

template <class... Values>
std::string octets_of(const Values&... values) {
  std::ostringstream out(std::ios::binary);
  cereal::BinaryOutputArchive archive(out);
  archive(values...);
  return std::move(out).str();
}

// Overloads that cereal finds by these names.
template <class T>
std::enable_if_t<std::is_arithmetic_v<T>> CEREAL_LOAD_FUNCTION_NAME(OctetArchive& archive, T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    std::uint8_t octet = 0;
    archive.loadBinary(&octet, 1);
    if (octet > 1) throw cereal::Exception("neither true nor false");
    value = octet == 1;
  } else {
    archive.loadBinary(&value, sizeof value);
  }
}
template <class T>
void CEREAL_LOAD_FUNCTION_NAME(OctetArchive& archive, cereal::NameValuePair<T>& named) {
  archive(named.value);
}
template <class T>
void CEREAL_LOAD_FUNCTION_NAME(OctetArchive& archive, cereal::SizeTag<T>& count) {
  archive(count.size);
  archive.check_room(count.size);
}
template <class T>
void CEREAL_LOAD_FUNCTION_NAME(OctetArchive& archive, cereal::BinaryData<T>& data) {
  archive.loadBinary(data.data, static_cast<std::size_t>(data.size));
}

// Reads values from octets; throws UserError when they are damaged.
template <class... Values>
void read_octets_of(int version, const std::string& octets, Values&... values) {
  try {
    OctetArchive archive(octets, version);
    archive(values...);
  } catch (const std::exception&) {
    throw UserError("a row of the map file is not what it should be");
  }
}
template <class... Values>
void read_octets(const std::string& octets, Values&... values) {
  read_octets_of(kRowsVersion, octets, values...);
}

// Reads values from a row of the table "state"; they stay as they are when there is none.
template <class... Values>
void read_state(const Tables& tables, StateRow row, Values&... values) {
  const auto table = tables.find("state");
  if (table == tables.end()) return;
  const auto at = table->second.find(static_cast<std::int64_t>(row));
  if (at != table->second.end()) read_octets(at->second, values...);
}

}  // namespace coslam

namespace cereal::traits::detail {
template <>
struct get_output_from_input<coslam::OctetArchive> {
  using type = BinaryOutputArchive;
};
}  // namespace cereal::traits::detail
