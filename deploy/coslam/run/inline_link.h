// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "agent/link/agent_link.h"
#include "server/fleet/link/server_link.h"

namespace coslam {

class InlineServer;

// Both ends of the link in one process and one thread: no waiting, no clock, no loss, the same order every time. Every
// value passes through the codec, so that its bits and its byte count are those of a run over DDS.
class InlineLink {
 public:
  explicit InlineLink(RunId server_run);
  ~InlineLink();
  InlineLink(const InlineLink&) = delete;
  InlineLink& operator=(const InlineLink&) = delete;

  ServerLink& server();
  // An agent starts; deleting the result ends it (AgentGone). It must not outlive this object.
  std::unique_ptr<AgentLink> connect(const Hello& hello);
  // The server has not answered this agent's newest frame yet, as when it needs others' frames first: in lock-step the
  // agent would wait, and here nobody else would run.
  bool owes_answer(RunId agent_run) const;

 private:
  std::unique_ptr<InlineServer> server_;
};

}  // namespace coslam
