// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <tuple>

#include "common/wire/participant.h"

namespace coslam {

// A writer for each of several types of message, all in one partition. Types: SelectedTypes. Thread-safe.
template <class Types>
class Writers;

template <class... Types>
class Writers<std::tuple<Types...>> : Writer<typename Types::Message>... {
 public:
  explicit Writers(Participant& participant, const std::string& partition = {})
      : Writer<typename Types::Message>(participant, partition)... {}

  template <class Message>
  Writer<Message>& writer() {
    return *this;
  }
  template <class Message>
  const Writer<Message>& writer() const {
    return *this;
  }
};

}  // namespace coslam
