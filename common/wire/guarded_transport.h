// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "common/wire/counters.h"
#include "common/wire/guard.h"
#include "common/wire/middleware.h"

// Internal header of this folder: it includes much of the middleware.
namespace coslam {

// A transport that seals what it sends over `carrier` and passes on what it can open: the middleware, which stops the
// process on some malformed datagrams, reads none of a stranger. Refused ones are counted in `refused`, which outlives
// the participant, and logged, once a minute at most. Messages are kSealBytes smaller than those of `carrier`.
std::shared_ptr<rtps::TransportDescriptorInterface> guarded_transport(
    std::shared_ptr<rtps::TransportDescriptorInterface> carrier, const FleetKey& key, RejectionCounts& refused);

}  // namespace coslam
