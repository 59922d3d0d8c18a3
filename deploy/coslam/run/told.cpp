// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/told.h"

#include "deploy/coslam/run/run.h"

namespace coslam {

RunTold::RunTold(const ViewConfig& view, ServerLoop& loop) {
  if (view.on()) {
    say_view("view: " + view_.emplace(view, loop, std::vector<PublicSink*>{&log_}).url());
  } else {
    teller_.emplace(loop, std::vector<PublicSink*>{&log_});
  }
}

}  // namespace coslam
