// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "common/wire/codec.h"
#include "tests/support/wire_values.h"

namespace coslam::test {

// The message of a value of WireValues, whatever its type.
template <class Value>
auto encoded(const Value& value) {
  if constexpr (std::is_same_v<Value, TrackFrame>) {
    return encode(value, pixel_scale(vga_camera()));
  } else {
    return encode(value);
  }
}

}  // namespace coslam::test
