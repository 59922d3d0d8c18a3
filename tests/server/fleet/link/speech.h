// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "agent/link/dds_agent_link.h"
#include "tests/server/fleet/link/echo_server.h"
#include "tests/support/child_process.h"
#include "tests/support/test_domain.h"
#include "tests/support/wire_equal.h"
#include "tests/support/wire_values.h"

// Agents and a server that talk over the real middleware, through the loopback device.
namespace coslam::test {

inline const RunId kServer(77);

class DdsLinks : public testing::Test {
 protected:
  ChildProcess agent_child(const std::string& name, std::uint64_t run) const {
    return ChildProcess({LINK_CHILD, "agent", std::to_string(domain_.number()), name, std::to_string(run)});
  }
  ChildProcess server_child(std::uint64_t run) const {
    return ChildProcess({LINK_CHILD, "server", std::to_string(domain_.number()), std::to_string(run)});
  }

  TestDomain domain_;
  WireConfig config_ = loopback_config(domain_.number());
};

struct Spoken {
  TrackFrame frame;
  std::optional<PatchReply> patches;
  std::optional<DescriptorReply> descriptors;
};

// Frames of an agent, some with replies.
inline std::vector<Spoken> speech(const std::string& name, RunId run, std::uint32_t frames) {
  WireValues values(run.value);
  std::vector<Spoken> all;
  for (std::uint32_t i = 0; i < frames; ++i) {
    Spoken s{values.frame(name, run, i), {}, {}};
    if (i % 3 == 1) s.patches = values.patches(s.frame, 30);
    if (i % 10 == 5) s.descriptors = values.descriptors(s.frame, 800);
    s.frame.patches_sent = s.patches ? 30 : 0;
    s.frame.descriptors_sent = s.descriptors ? DescriptorsSent::kWithFrame : DescriptorsSent::kNone;
    all.push_back(std::move(s));
  }
  return all;
}

// Plays in lock-step; returns the number of frames that were answered.
inline std::uint32_t play(AgentLink& link, const std::vector<Spoken>& all) {
  std::uint32_t answered = 0;
  for (const Spoken& s : all) {
    link.send(s.frame, s.patches, s.descriptors);
    std::optional<MapPatch> patch;
    do {
      patch = link.wait_patch(s.frame.frame, kDeadline);
    } while (patch && patch->after_frame < s.frame.frame);
    if (!patch) break;
    ++answered;
  }
  return answered;
}

inline void expect_heard(const std::vector<JoinedFrame>& heard, const std::vector<Spoken>& all) {
  ASSERT_EQ(heard.size(), all.size()) << "every frame once";
  for (std::size_t i = 0; i < all.size(); ++i) {
    expect_same(heard[i].frame, all[i].frame);
    ASSERT_EQ(heard[i].patches.has_value(), all[i].patches.has_value());
    if (heard[i].patches) expect_same(*heard[i].patches, *all[i].patches);
    ASSERT_EQ(heard[i].descriptors.has_value(), all[i].descriptors.has_value());
    if (heard[i].descriptors) expect_same(*heard[i].descriptors, *all[i].descriptors);
  }
}

}  // namespace coslam::test
