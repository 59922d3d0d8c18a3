// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/play_start.h"

namespace coslam {
namespace {

constexpr double kMostUsual_s = 0.25;
constexpr int kEnough = 3;

}  // namespace

std::optional<PlayStart::Known> PlayStart::heard(const ServerStatus& status, double clock_ahead_s) {
  if (clock_ahead_s >= 0 && clock_ahead_s < kMostUsual_s) return Known{status.start_utc_ns, 0};
  if (++unusual_ < kEnough) return std::nullopt;
  return Known{status.start_utc_ns + to_ns(clock_ahead_s), clock_ahead_s};
}

}  // namespace coslam
