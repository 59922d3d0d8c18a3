// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/dataset/result_folder.h"
#include "server/show/publish/snapshot.h"

namespace coslam::exporting {

// Events of cameras, groups and maps in a run, in sentences, by time: from events.csv and groups.csv, as far as they
// are there.
std::vector<PublicEvent> public_events(const ResultFolder& result);

}  // namespace coslam::exporting
