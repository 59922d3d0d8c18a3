// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/live_view.h"

#include <utility>

#include "common/base/text.h"

namespace coslam {
namespace {

std::vector<PublicSink*> with(std::vector<PublicSink*> some, const std::vector<PublicSink*>& others) {
  some.insert(some.end(), others.begin(), others.end());
  return some;
}

}  // namespace

LiveView::LiveView(const ViewConfig& config, const MapServer& server, const std::vector<PublicSink*>& others,
                   ThumbnailSource thumbnails)
    : web_(config, format_hex(server.run().value),
           [this](const WebRequest& request, WebReply reply) { api_.answer(request, std::move(reply)); }),
      teller_(server, with({&api_, &web_}, others)) {
  api_.count([this] { return web_.counts(); });
  if (thumbnails) api_.look_by(std::move(thumbnails));
}

}  // namespace coslam
