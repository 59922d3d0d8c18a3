// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/inline_link.h"

#include <deque>
#include <map>

#include "agent/link/inbox.h"
#include "common/base/check.h"
#include "common/wire/codec.h"
#include "common/wire/participant.h"
#include "common/wire/reply_parts.h"
#include "common/wire/track_codec.h"
#include "server/fleet/link/sessions.h"

namespace coslam {

using std::chrono::milliseconds;

// One agent's end.
class InlineAgent : public AgentLink {
 public:
  InlineAgent(InlineServer& server, const Hello& hello);
  ~InlineAgent() override;
  InlineAgent(const InlineAgent&) = delete;
  InlineAgent& operator=(const InlineAgent&) = delete;

  void send(TrackFrame frame, const std::optional<PatchReply>& patches,
            const std::optional<DescriptorReply>& descriptors) override;
  void send(const AgentMessage& message) override;

  std::optional<MapPatch> wait_patch(FrameId after_frame, milliseconds) override {
    return inbox_.answered(after_frame) ? std::nullopt : inbox_.pop();
  }
  std::vector<MapPatch> take_patches() override;
  bool is_owed() const { return sent_ && (!inbox_.acknowledged() || *inbox_.acknowledged() < *sent_); }
  std::optional<ServerStatus> server_status() const override { return inbox_.status(); }
  std::optional<ServerStatus> wait_server_status(milliseconds) override { return inbox_.take_fresh_status(); }
  std::optional<AgentImages> images() const override { return inbox_.images(); }
  bool server_alive() const override { return inbox_.status().has_value(); }
  LinkBytes bytes() const override { return bytes_; }
  const RejectionCounts& rejections() const override { return rejections_; }

  template <class Message>
  void receive(const Message& message, std::uint64_t bytes);

 private:
  template <class Message>
  void pass_up(const Message& message);
  template <class Reply>
  void pass_up_parts(const Reply& reply) {
    for (const Reply& part : in_parts(reply)) pass_up(encode(part));
  }

  InlineServer& server_;
  const RunId run_;
  TrackEncoder encoder_;
  std::optional<FrameId> sent_;  // the newest
  Inbox inbox_;
  LinkBytes bytes_;
  RejectionCounts rejections_;
};

class InlineServer : public ServerLink {
 public:
  explicit InlineServer(RunId run) : sessions(milliseconds(0), rejection_counts) { status.server_run = run; }

  bool at_work() const override { return true; }
  std::optional<ServerEvent> next_event(milliseconds) override {
    if (events.empty()) return std::nullopt;
    std::optional<ServerEvent> event(std::move(events.front()));
    events.pop_front();
    return event;
  }

  // What goes to all agents do not read, and nobody else can.
  void send(const ServerMessage& message) override {
    message.visit([this](const auto& value) {
      if constexpr (goes_to_run(topic_of<decltype(encode(value))>())) pass_down(value);
    });
  }
  template <class Value>
  void pass_down(const Value& value) {
    const auto agent = agents.find(value.agent_run);
    if (agent == agents.end() || !sessions.knows(value.agent_run)) return;
    const auto message = encode(value);
    sessions.count_down(value.agent_run, cost(message));
    agent->second->receive(message, cost(message));
  }

  void send_status(const ServerStatus& s) override {
    status = s;
    publish_status();
  }

  void refuse(const Hello& hello, const std::string& reason) override {
    sessions.refuse(hello, reason);
    publish_status();
  }

  LinkBytes bytes(const std::string& agent) const override { return sessions.bytes(agent); }
  ServerLinkCounts counts() const override { return {0, sessions.late_replies(), 0}; }
  const RejectionCounts& rejections() const override { return rejection_counts; }

  template <class Message>
  static std::uint64_t cost(const Message& message) {
    return link_bytes(sample_bytes(message), WireConfig().max_message_bytes);
  }

  void publish_status() {
    status.refused = sessions.refused();
    published_refusals = status.refused.empty() ? RunId() : status.refused.back().agent_run;
    const idl::ServerStatus message = encode(status);
    sessions.count_down_all(cost(message));
    for (const auto& [run, agent] : agents) agent->receive(message, cost(message));
  }

  // A new agent hears the newest status first.
  void connect(RunId run, InlineAgent& agent) {
    COSLAM_CHECK(agents.emplace(run, &agent).second, "runs are drawn at random and differ");
    const idl::ServerStatus message = encode(status);
    agent.receive(message, cost(message));
  }

  // Time does not pass, and every way back is open: what is undecided is decided now.
  void after_change() {
    sessions.tick({});
    for (const RunId run : sessions.waiting()) sessions.open(run);
    for (ServerEvent& event : sessions.take_events()) events.push_back(std::move(event));
    const std::vector<Refusal>& refused = sessions.refused();
    if (!refused.empty() && refused.back().agent_run != published_refusals) publish_status();
  }

  RejectionCounts rejection_counts;
  Sessions sessions;
  ServerStatus status;
  std::deque<ServerEvent> events;
  std::map<RunId, InlineAgent*> agents;
  RunId published_refusals;
};

InlineAgent::InlineAgent(InlineServer& server, const Hello& hello)
    : server_(server), run_(hello.agent_run), encoder_(pixel_scale(hello.camera)), inbox_(hello.agent_run) {
  server_.connect(run_, *this);
  pass_up(encode(hello));
}

InlineAgent::~InlineAgent() {
  server_.agents.erase(run_);
  server_.sessions.presence(run_, Presence::kGone);
  server_.after_change();
}

template <class Message>
void InlineAgent::pass_up(const Message& message) {
  const std::uint64_t bytes = InlineServer::cost(message);
  bytes_.up += bytes;
  server_.sessions.receive(message, bytes, {});
  server_.after_change();
}

template <class Message>
void InlineAgent::receive(const Message& message, std::uint64_t bytes) {
  bytes_.down += bytes;
  auto value = decode(message);
  COSLAM_CHECK(value, "the server sends what its own decoder would refuse");
  if (const auto reason = inbox_.add(std::move(*value))) rejections_.add(*reason);
}

void InlineAgent::send(TrackFrame frame, const std::optional<PatchReply>& patches,
                       const std::optional<DescriptorReply>& descriptors) {
  frame.patches_sent = patches ? static_cast<std::uint16_t>(patches->patches.size()) : std::uint16_t{0};
  if (descriptors) frame.descriptors_sent = DescriptorsSent::kWithFrame;
  if (patches) pass_up_parts(*patches);
  if (descriptors) pass_up_parts(*descriptors);
  sent_ = frame.frame;
  pass_up(encoder_.encode(frame, inbox_.acknowledged()));
}

void InlineAgent::send(const AgentMessage& message) {
  message.visit([this](const auto& value) { pass_up(encode(value)); });
}

std::vector<MapPatch> InlineAgent::take_patches() {
  std::vector<MapPatch> patches;
  while (auto patch = inbox_.pop()) patches.push_back(std::move(*patch));
  return patches;
}

InlineLink::InlineLink(RunId server_run) : server_(std::make_unique<InlineServer>(server_run)) {}
InlineLink::~InlineLink() = default;

bool InlineLink::owes_answer(RunId agent_run) const {
  const auto at = server_->agents.find(agent_run);
  return at != server_->agents.end() && at->second->is_owed();
}

ServerLink& InlineLink::server() { return *server_; }

std::unique_ptr<AgentLink> InlineLink::connect(const Hello& hello) {
  require_valid(hello);
  return std::make_unique<InlineAgent>(*server_, hello);
}

}  // namespace coslam
