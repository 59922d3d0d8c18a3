// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/live_view.h"

#include <utility>

#include "common/base/text.h"
#include "server/app/server_loop.h"

namespace coslam {
namespace {

std::vector<PublicSink*> with(std::vector<PublicSink*> some, const std::vector<PublicSink*>& others) {
  some.insert(some.end(), others.begin(), others.end());
  return some;
}

}  // namespace

LiveView::LiveView(const ViewConfig& config, ServerLoop& loop, const std::vector<PublicSink*>& others)
    : web_(config, format_hex(loop.map_server().run().value),
           [this](const WebRequest& request, WebReply reply) { api_.answer(request, std::move(reply)); }),
      teller_(loop, with({&api_, &web_}, others)) {
  api_.count([this] { return web_.counts(); });
}

void LiveView::look_by(ServerLink& link) {
  api_.look_by([&link](const std::string& agent) { return link.thumbnail(agent); });
}

}  // namespace coslam
