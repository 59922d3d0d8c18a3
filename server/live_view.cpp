// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_view.h"

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <utility>

#include "common/flow/clock.h"
#include "server/server_loop.h"

namespace coslam {
namespace {

std::string text_of(RunId run) {
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(run.value));
  return text.data();
}

// Processor time of this thread: when others displace it, that is not what viewers cost.
std::chrono::nanoseconds processor_time() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
}

}  // namespace

LiveView::LiveView(const ViewConfig& config, ServerLoop& loop)
    : watch_(loop.map_server()),
      web_(config, text_of(loop.map_server().run()),
           [this](const WebRequest& request, WebReply reply) { api_.answer(request, std::move(reply)); }),
      publication_({&api_, &web_}) {
  api_.count([this] { return web_.counts(); });
  loop.observe(this);
}

void LiveView::tell(Snapshot snapshot) {
  if (!snapshot.empty()) publication_.put(std::move(snapshot));
}

LoopFacts LiveView::facts(const ServerLoop& loop) const {
  LoopFacts out = loop.facts();
  for (const auto& [name, h] : times_.stages()) {
    out.watching = {h.percentile_ms(50), h.percentile_ms(95), h.percentile_ms(99),
                    h.mean_ms() * static_cast<double>(h.count()), h.count()};
  }
  return out;
}

void LiveView::after_set(const FrameSet& set, const ServerLoop& loop) {
  const auto before = processor_time();
  tell(
      watch_.after_set(set, loop.map_server(), publication_.wanted(), monotonic_now_ns(), [&] { return facts(loop); }));
  times_.add("view", processor_time() - before);
}

void LiveView::in_between(const ServerLoop& loop) {
  tell(watch_.in_between(loop.map_server(), publication_.wanted(), monotonic_now_ns(), [&] { return facts(loop); }));
}

void LiveView::finishing(const ServerLoop& loop) { finished(loop); }

void LiveView::finished(const ServerLoop& loop) {
  tell(watch_.at_the_end(loop.map_server(), publication_.wanted(), monotonic_now_ns(), [&] { return facts(loop); }));
}

}  // namespace coslam
