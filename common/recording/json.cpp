// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/recording/json.h"

namespace coslam::recording {
namespace {

constexpr std::uint8_t kNoDigit = 64;

// The value of each character as a digit.
constexpr std::array<std::uint8_t, 256> kDigits = [] {
  constexpr std::string_view kAll = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<std::uint8_t, 256> digits{};
  digits.fill(kNoDigit);
  for (std::size_t i = 0; i < kAll.size(); ++i) {
    digits[static_cast<unsigned char>(kAll[i])] = static_cast<std::uint8_t>(i);
  }
  return digits;
}();

}  // namespace

std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::vector<std::uint8_t> octets;
  octets.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t gathered = 0;
  unsigned bits = 0;
  for (const char c : text) {
    const std::uint8_t digit = kDigits[static_cast<unsigned char>(c)];
    if (digit == kNoDigit) return std::nullopt;
    gathered = gathered << 6U | digit;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    octets.push_back(static_cast<std::uint8_t>(gathered >> bits));
  }
  return octets;
}

nlohmann::json parsed_json(std::string_view text) {
  constexpr int kDeepest = 8;
  bool too_deep = false;
  const nlohmann::json::parser_callback_t shallow = [&](int depth, nlohmann::json::parse_event_t /*event*/,
                                                        nlohmann::json& /*parsed*/) {
    too_deep = too_deep || depth > kDeepest;
    return !too_deep;
  };
  auto json = nlohmann::json::parse(text, shallow, false);
  return too_deep ? nlohmann::json(nlohmann::json::value_t::discarded) : std::move(json);
}

}  // namespace coslam::recording
