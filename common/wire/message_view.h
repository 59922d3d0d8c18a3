// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>
#include <variant>

#include "common/wire/messages.h"

namespace coslam {

// A message of one of several types by reference, as an argument: the message outlives the call. Types: SelectedTypes.
template <class Types>
class MessageView;

template <class... Types>
class MessageView<std::tuple<Types...>> {
 public:
  template <class Value>
  // NOLINTNEXTLINE(google-explicit-constructor): converts by intent
  requires kIsOneOf<Value, typename Types::Value...> MessageView(const Value& value) : value_(&value) {}

  // Calls visit(value) with the value that the message is.
  template <class Visit>
  void visit(const Visit& visit) const {
    std::visit([&](const auto* value) { visit(*value); }, value_);
  }

 private:
  std::variant<const typename Types::Value*...> value_;
};

}  // namespace coslam
