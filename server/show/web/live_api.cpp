// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/live_api.h"

#include <algorithm>
#include <utility>

#include "common/flow/give_way.h"
#include "server/show/publish/json.h"
#include "server/show/publish/metrics.h"
#include "server/show/web/explain_answer.h"
#include "server/show/web/ply.h"

namespace coslam {
namespace {

using namespace std::chrono_literals;

constexpr auto kStandsStill = 30s, kFreshCloud = 2s, kLongestWait = 10s;
constexpr std::size_t kMostQuestions = 4, kMostWaiting = 100;
constexpr const char* kJson = "application/json";

WebAnswer not_begun() { return plain_answer(503, "nothing is known of the map yet"); }

void put_counts(const WebCounts& c, MetricsText* text) {
  using Kind = MetricsText::Kind;
  const auto one = [&](const char* name, Kind kind, const char* help, std::uint64_t n) {
    text->one(name, kind, help, static_cast<double>(n));
  };
  one("coslam_view_connections", Kind::kGauge, "Open connections of the web server", c.open);
  one("coslam_view_subscribers", Kind::kGauge, "Those that are sent messages", c.subscribers);
  one("coslam_view_connections_total", Kind::kCounter, "Connections", c.connections);
  one("coslam_view_turned_away_total", Kind::kCounter, "Connections that there was no room for", c.turned_away);
  one("coslam_view_refused_total", Kind::kCounter, "Requests and texts that were no good", c.refused);
  one("coslam_view_cut_off_total", Kind::kCounter, "Subscribers that did not take what they were sent", c.cut_off);
  one("coslam_view_sent_total", Kind::kCounter, "Messages sent", c.sent);
  one("coslam_view_dropped_total", Kind::kCounter, "Messages that a slow subscriber did not get", c.dropped);
}

}  // namespace

LiveApi::LiveApi()
    : questions_(kMostQuestions, QueuePolicy::kRefuse), worker_("explain", [this](const std::stop_token& stop) {
        give_way();
        const std::stop_callback close(stop, [this] { questions_.close(); });
        while (const auto question = questions_.pop()) (*question)();
      }) {}

void LiveApi::count(std::function<WebCounts()> counts) {
  const std::lock_guard lock(mutex_);
  counts_ = std::move(counts);
}

void LiveApi::look_by(ThumbnailOf thumbnail_of) {
  const std::lock_guard lock(mutex_);
  thumbnail_of_ = std::move(thumbnail_of);
}

void LiveApi::answer(const WebRequest& request, WebReply reply) {
  const std::string& path = request.path;
  if (path == "/api/v1/map.ply") return map(std::move(reply));
  if (path == "/api/v1/explain") return explain(request, reply);
  const std::unique_lock lock(mutex_);
  if (path == "/healthz") return reply(health());
  if (path == "/readyz") return reply(ready());
  if (path == "/metrics") return reply(metrics());
  if (path == "/api/v1/agents")
    return reply(state_ ? answer_of(agents_json(*state_, rates_, names_), kJson) : not_begun());
  if (path == "/api/v1/groups") return reply(state_ ? answer_of(groups_json(*state_), kJson) : not_begun());
  if (path == "/api/v1/thumbnail") return reply(thumbnail(request));
  reply(plain_answer(
      404, "there is nothing at " + path +
               "; there are /api/v1/agents, groups, map.ply, thumbnail and explain, /metrics, /healthz and /readyz"));
}

WebAnswer LiveApi::health() const {
  const bool finishing = state_ && state_->loop.finishing;  // a long run is adjusted for minutes
  const auto age = Clock::now() - state_at_;
  if (finishing || age < kStandsStill) return plain_answer(200, "ok");
  return plain_answer(503, "the map has stood still for " +
                               std::to_string(std::chrono::duration_cast<std::chrono::seconds>(age).count()) + " s");
}

WebAnswer LiveApi::ready() const {
  if (!state_ || !state_->loop.at_work) return plain_answer(503, "the server is not at work yet");
  bool alive = false;
  for (const PublicAgent& a : state_->agents) {
    if (a.alive && a.cam_from_map) return plain_answer(200, "ok");
    alive |= a.alive;
  }
  return plain_answer(503, alive ? "no agent has a place in a map yet" : "there are no agents");
}

WebAnswer LiveApi::metrics() const {
  MetricsText text;
  text.one("coslam_up", MetricsText::Kind::kGauge, "1: the map moves on", health().status == 200 ? 1 : 0);
  if (state_) put_metrics(*state_, &text);
  if (counts_) put_counts(counts_(), &text);
  return answer_of(text.take(), std::string(kMetricsType));
}

WebAnswer LiveApi::thumbnail(const WebRequest& request) const {
  const auto asked = request.query.find("agent");
  if (asked == request.query.end()) return plain_answer(400, "which agent's image? ?agent=NAME is missing");
  const std::string& name = asked->second;
  const auto is_asked = [&](const PublicAgent& a) { return a.facts.name == name; };
  if (!state_ || std::ranges::none_of(state_->agents, is_asked)) {
    return plain_answer(404, "there is no agent '" + name + "'");
  }
  if (!thumbnail_of_) return plain_answer(404, "the agents of this run give no images");
  const auto thumbnail = thumbnail_of_(name);
  if (!thumbnail) {
    return plain_answer(202, name + " is asked for an image: ask again in a second. None comes while it plays nothing");
  }
  if (thumbnail->jpeg.empty()) {
    return plain_answer(403, name + " keeps its images to itself: agent.thumbnails is false there");
  }
  return answer_of(std::string(thumbnail->jpeg.begin(), thumbnail->jpeg.end()), "image/jpeg");
}

void LiveApi::map(WebReply reply) {
  std::shared_ptr<const PublicCloud> cloud;
  {
    const std::lock_guard lock(mutex_);
    if (cloud_ && Clock::now() - cloud_at_ < kFreshCloud) {
      cloud = cloud_;
    } else if (waiting_.size() < kMostWaiting) {
      waiting_.push_back({std::move(reply), Clock::now()});
      wants_cloud_ = true;
      return;
    }
  }
  reply(cloud ? answer_of(ply_of(*cloud), "application/octet-stream") : plain_answer(503, "too many wait for the map"));
}

void LiveApi::explain(const WebRequest& request, const WebReply& reply) {
  const auto question = question_of(request);
  if (!question) return reply(no_question());
  std::string result;
  {
    const std::lock_guard lock(mutex_);
    if (!state_ || state_->agents.empty()) return reply(plain_answer(404, "nothing yet: no agent has come"));
    result = state_->loop.result;
  }
  if (result.empty()) return reply(plain_answer(404, "the run keeps no result: nothing can be explained"));
  if (!questions_.push([=] { reply(explained(ResultFolder(result), *question)); }))
    reply(plain_answer(503, "too many questions at once"));
}

PartSet LiveApi::parts() const { return wants_cloud_ ? PartSet(Part::kCloud) : PartSet(); }

void LiveApi::see(const Snapshot& snapshot) {
  std::vector<Waiting> answered;
  std::shared_ptr<const PublicCloud> cloud;
  {
    const std::lock_guard lock(mutex_);
    if (snapshot.state) {
      state_ = snapshot.state;
      state_at_ = Clock::now();
      rates_.see(*state_);
      for (const PublicAgent& a : state_->agents) names_.ros_name(a.facts.name);
    }
    if (snapshot.cloud) {
      cloud_ = snapshot.cloud;
      cloud_at_ = Clock::now();
    }
    const bool too_long = !waiting_.empty() && Clock::now() - waiting_.front().received > kLongestWait;
    if (snapshot.cloud || too_long) answered = std::exchange(waiting_, {});
    wants_cloud_ = !waiting_.empty();
    cloud = cloud_;
  }
  if (answered.empty()) return;
  const WebAnswer answer = cloud ? answer_of(ply_of(*cloud), "application/octet-stream") : not_begun();
  for (const Waiting& w : answered) w.reply(answer);
}

}  // namespace coslam
