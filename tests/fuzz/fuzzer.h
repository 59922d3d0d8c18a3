// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

// A target of libFuzzer: each source beside this one defines the two functions below, fuzzer.cpp is what they share.
namespace coslam::fuzz {

using Octets = std::span<const std::uint8_t>;

// Anything but a value or a UserError is a finding.
void try_octets(Octets octets);

// Good inputs, to begin with: small, and made anew whenever a format changes.
using WriteSeed = std::function<void(const std::string& name, std::string_view octets)>;
void write_seeds(const WriteSeed& write);

inline std::string_view text_of(Octets octets) { return {reinterpret_cast<const char*>(octets.data()), octets.size()}; }

// A file in memory with this content, until the next call.
std::filesystem::path file_of(std::string_view content);

}  // namespace coslam::fuzz
