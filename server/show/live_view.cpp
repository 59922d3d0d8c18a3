// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/live_view.h"

#include <utility>

#include "common/base/text.h"

namespace coslam {
namespace {

std::vector<PublicSink*> with_sinks(std::vector<PublicSink*> sinks, const std::vector<PublicSink*>& more_sinks) {
  sinks.insert(sinks.end(), more_sinks.begin(), more_sinks.end());
  return sinks;
}

}  // namespace

LiveView::LiveView(const ViewConfig& config, const MapServer& server, const std::vector<PublicSink*>& more_sinks,
                   ThumbnailSource thumbnails)
    : web_(config, format_hex(server.run().value),
           [this](const WebRequest& request, WebReply reply) { api_.answer(request, std::move(reply)); }),
      teller_(server, with_sinks({&api_, &web_}, more_sinks)) {
  api_.count([this] { return web_.counts(); });
  if (thumbnails) api_.look_by(std::move(thumbnails));
}

}  // namespace coslam
