// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/link/clock_lead.h"

#include <gtest/gtest.h>

namespace coslam::clock_lead_test {
namespace {

TEST(ClockLeadTest, FirstStatusMayHaveBeenKept) {
  ClockLead lead;
  lead.note(1.5, true, false);
  EXPECT_FALSE(lead.seconds());
  lead.note(0.5, false, false);
  EXPECT_EQ(lead.seconds(), 0.5);
}

TEST(ClockLeadTest, LeastTimeCounts) {
  ClockLead lead;
  for (const double took_s : {0.75, 0.25, 0.5}) lead.note(took_s, false, false);
  EXPECT_EQ(lead.seconds(), 0.25);
}

TEST(ClockLeadTest, FirstStatusCountsWhenItCannotHaveBeenKept) {
  for (const double took_s : {-0.5, 3.5}) {
    ClockLead lead;
    lead.note(took_s, true, false);
    EXPECT_EQ(lead.seconds(), took_s);
  }
  ClockLead lead;
  lead.note(1, true, true);
  EXPECT_EQ(lead.seconds(), 1);
}

TEST(ClockLeadTest, NewServerBeginsAnew) {
  ClockLead lead;
  lead.note(0.25, false, false);
  lead.note(1.5, true, false);
  EXPECT_FALSE(lead.seconds());
}

}  // namespace
}  // namespace coslam::clock_lead_test
