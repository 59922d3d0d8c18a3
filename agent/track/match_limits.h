// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Limits of the search in matching, and thresholds of success: the same on the CPU and on a GPU.
namespace coslam {

// Alignment of a window, see align.h.
constexpr int kFineIterations = 12;
constexpr int kCoarseIterations = 8;
constexpr float kConvergedFine_px = 0.01f;
constexpr float kConvergedCoarse_px = 0.05f;
constexpr float kWidestStep_px = 4.0f;  // the linearisation says nothing about further away
constexpr float kFurthest_px = 8.0f;    // distance from the start, in pixels of the level
constexpr float kLeastGain = 0.2f;
// With noise of 2 grey levels the standard deviation of the position is 2 / sqrt(16) = 0.5 px.
constexpr float kLeastTexture = 16.0f;
constexpr int kGuessLevel = 2;       // a window spans 64 px of level 0
constexpr float kAlike_zncc = 0.8f;  // less than about 10 px off

// Following of a track from image to image, see matcher.h.
constexpr int kRetryTop = 2;     // a start that neighbours lend needs no coarser levels, which their border may spoil
constexpr int kBackwardTop = 1;  // the way back starts where it should end, so the finest levels do
// Tolerances for moving tracks: moving things bend, turn and have other motions beside them, so a track may fit less
// well.
constexpr double kMovingZncc = 0.8;             // share of min_zncc
constexpr double kMovingForwardBackward = 2.5;  // multiple of forward_backward_px
constexpr int kMotionNeighbours = 5;            // neighbours whose median motion is lent

// Shift of the whole image, see global_shift().
constexpr int kShiftRadius = 6;  // shifts tried, pixels of the coarsest level

// Alignment of a track's first patch, see key_patch.h.
constexpr int kKeyIterations = 3;
constexpr float kKeyConverged_px = 0.03f;  // limit of the last step; the remaining error is far less
constexpr float kKeyFurthest_px = 4.0f;    // distance from the guess
constexpr float kKeyLeastGain = 0.1f;
constexpr float kWidestScale = 1.4f;       // beyond, the next coarser level is sampled, else pixels would be skipped
constexpr float kLeastDeterminant = 0.5f;  // minimum determinant of the affine change in one step

}  // namespace coslam
