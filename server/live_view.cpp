// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/live_view.h"

#include <array>
#include <cstdio>
#include <utility>

#include "server/server_loop.h"

namespace coslam {
namespace {

std::string text_of(RunId run) {
  std::array<char, 20> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(run.value));
  return text.data();
}

std::vector<PublicSink*> with(std::vector<PublicSink*> some, const std::vector<PublicSink*>& others) {
  some.insert(some.end(), others.begin(), others.end());
  return some;
}

}  // namespace

LiveView::LiveView(const ViewConfig& config, ServerLoop& loop, const std::vector<PublicSink*>& others)
    : web_(config, text_of(loop.map_server().run()),
           [this](const WebRequest& request, WebReply reply) { api_.answer(request, std::move(reply)); }),
      teller_(loop, with({&api_, &web_}, others)) {
  api_.count([this] { return web_.counts(); });
}

}  // namespace coslam
