// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace coslam {

class Map;
struct PastFrames;
struct PastPlaces;

// Checks a map that was read from a file, which may be anybody's: ids refer to existing entities, numbers are finite,
// times are such that sums of them stay in range. Throws UserError, one sentence, for the first violation.
void validate(const Map& map);
// Checks archived data of a valid map, and throws like validate().
void validate(const PastFrames& block, const Map& map);
void validate(const PastPlaces& block, const Map& map);

}  // namespace coslam
