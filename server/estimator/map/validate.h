// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace coslam {

class Map;
struct PastFrames;
struct PastPlaces;

// For a map that was read from a file, which may be anybody's: ids are of something that is there, numbers finite,
// times such that sums of them stay in range. Throws UserError, one sentence, for the first thing that is not so.
void validate(const Map& map);
// The same of what is past of that map, once the map is sound.
void validate(const PastFrames& block, const Map& map);
void validate(const PastPlaces& block, const Map& map);

}  // namespace coslam
