// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/app/stop_signals.h"

#include <gtest/gtest.h>

#include <csignal>

namespace coslam::stop_signals_test {
namespace {

using ::testing::ExitedWithCode;

// Signals are the process's: each test has one of its own.
TEST(StopSignals, AskToStop) {
  const auto asked = [] {
    catch_stop_signals();
    const bool before = stop_requested();
    std::raise(SIGINT);
    const bool asked_kindly = stop_requested() && !stop_is_urgent();
    std::raise(SIGTERM);
    std::exit(!before && asked_kindly && stop_is_urgent() ? 0 : 1);
  };
  EXPECT_EXIT(asked(), ExitedWithCode(0), "");
}

TEST(StopSignals, EndAtOnceWhileNothingIsLost) {
  for (const int code : {0, 1}) {
    const auto end = [code] {
      catch_stop_signals();
      std::raise(SIGINT);
      const EndsAtOnce now(code);
      std::raise(SIGTERM);
      std::exit(7);
    };
    EXPECT_EXIT(end(), ExitedWithCode(code), "");
  }
}

TEST(StopSignals, DoNotEndWhatComesAfter) {
  const auto go_on = [] {
    catch_stop_signals();
    { const EndsAtOnce now(0); }
    std::raise(SIGINT);
    std::exit(7);
  };
  EXPECT_EXIT(go_on(), ExitedWithCode(7), "");
}

}  // namespace
}  // namespace coslam::stop_signals_test
