// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "server/show/publish/names.h"
#include "server/show/publish/rates.h"
#include "server/show/publish/snapshot.h"

// The public topics that are JSON, see docs/live.md.
namespace coslam {

std::string state_json(const PublicState& state, const Rates& rates, RosNames& names);
// Parts of the same.
std::string agents_json(const PublicState& state, const Rates& rates, RosNames& names);
std::string groups_json(const PublicState& state);

std::string event_json(const PublicEvent& event);
// Pixels are those of the image as it was taken.
std::string tracks_json(const PublicImage& image);

// Their JSON schemas.
extern const std::string_view kStateSchema, kEventSchema, kTracksSchema;

}  // namespace coslam
