// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/wire/participant.h"

// Topics of others, whose samples are octets that somebody else encodes and decodes: keyless, plain CDR, encapsulation
// header included.
namespace coslam {

struct OctetTopic {
  std::string name, type;  // DDS names
  bool reliable = true;
  bool late_joiners = false;  // the writer keeps the newest samples for readers that come later (transient local)
  int depth = 1;              // samples that are kept
};

// Thread-safe. The participant outlives it.
class OctetWriter {
 public:
  OctetWriter(Participant& participant, const OctetTopic& topic);
  ~OctetWriter();
  OctetWriter(const OctetWriter&) = delete;
  OctetWriter& operator=(const OctetWriter&) = delete;

  bool write(std::span<const std::uint8_t> octets);  // false: the middleware could not take it
  int readers() const;                               // matched now

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Hands each sample on, on a thread of the middleware, until it is destroyed.
class OctetReader {
 public:
  using OnSample = std::function<void(std::span<const std::uint8_t> octets)>;
  OctetReader(Participant& participant, const OctetTopic& topic, OnSample on_sample);
  ~OctetReader();
  OctetReader(const OctetReader&) = delete;
  OctetReader& operator=(const OctetReader&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace coslam
