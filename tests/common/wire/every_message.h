// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <tuple>

#include "tests/common/wire/encoded.h"

// Tests that hold for every type of message: TYPED_TEST_SUITE(..., MessageTypes, MessageName).
namespace coslam::test {

template <class... Types>
testing::Types<Types...> types_of(const std::tuple<Types...>&);
using MessageTypes = decltype(types_of(kMessageTypes));

// The name of a type in the names of tests: that of its topic without "coslam/".
struct MessageName {
  template <class Type>
  static std::string GetName(int) {
    return std::string(topic_of<typename Type::Message>().name).substr(std::string_view("coslam/").size());
  }
};

}  // namespace coslam::test
