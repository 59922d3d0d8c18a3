// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/told.h"

#include "deploy/coslam/run/run.h"

namespace coslam {

RunTold::RunTold(const ViewConfig& view, ServerLoop& loop) {
  if (view.on()) {
    view_.emplace(view, loop.map_server(), std::vector<PublicSink*>{&log_});
    say_view("view: " + view_->url());
    loop.observe(view_->observer());
  } else {
    loop.observe(teller_.emplace(loop.map_server(), std::vector<PublicSink*>{&log_}));
  }
}

}  // namespace coslam
