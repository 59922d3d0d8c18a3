// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/match_program.h"

#include <iomanip>
#include <ios>
#include <limits>
#include <locale>
#include <sstream>

#include "agent/track/cell_corners.h"
#include "agent/track/corner_score.h"
#include "agent/track/match_limits.h"
#include "agent/track/samples.h"
#include "agent/track/window.h"

namespace coslam {

std::string match_program() {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << std::showpoint << std::setprecision(std::numeric_limits<float>::max_digits10);
  const auto whole = [&](const char* name, int value) { out << "#define " << name << " " << value << "\n"; };
  const auto real = [&](const char* name, double value) { out << "#define " << name << " " << value << "f\n"; };
  whole("WINDOW_SIDE", kWindowSide);
  whole("WINDOW_AREA", kWindowArea);
  real("WINDOW_HALF", kWindowHalf_px);
  real("WINDOW_REACH", kWindowReach_px);
  whole("MARGIN", PyramidLevel::kMargin);
  whole("WEIGHT_SUM", kWeightSum);
  whole("WEIGHT_SHIFT", kWeightShift);
  whole("SAMPLE_UNIT", kSampleUnit);
  whole("SAMPLE_CENTRE", kSampleCentre);
  whole("TEMPLATE_UNIT", kTemplateUnit);
  whole("TEMPLATE_SHIFT", kTemplateShift);
  whole("FINE_ITERATIONS", kFineIterations);
  whole("COARSE_ITERATIONS", kCoarseIterations);
  real("CONVERGED_FINE_PX", kConvergedFine_px);
  real("CONVERGED_COARSE_PX", kConvergedCoarse_px);
  real("WIDEST_STEP_PX", kWidestStep_px);
  real("FURTHEST_PX", kFurthest_px);
  real("LEAST_GAIN", kLeastGain);
  real("LEAST_TEXTURE", kLeastTexture);
  whole("GUESS_LEVEL", kGuessLevel);
  real("ALIKE_ZNCC", kAlike_zncc);
  whole("RETRY_TOP", kRetryTop);
  whole("BACKWARD_TOP", kBackwardTop);
  real("MOVING_ZNCC", kMovingZncc);
  real("MOVING_FORWARD_BACKWARD", kMovingForwardBackward);
  whole("MOTION_NEIGHBOURS", kMotionNeighbours);
  whole("SHIFT_RADIUS", kShiftRadius);
  whole("SHIFT_SIDE", kShiftSide);
  whole("KEY_ITERATIONS", kKeyIterations);
  real("KEY_CONVERGED_PX", kKeyConverged_px);
  real("KEY_FURTHEST_PX", kKeyFurthest_px);
  real("KEY_LEAST_GAIN", kKeyLeastGain);
  real("WIDEST_SCALE", kWidestScale);
  real("LEAST_DETERMINANT", kLeastDeterminant);
  whole("CORNER_HALF", kCornerHalf);
  whole("PRODUCT_SHIFT", kProductShift);
  real("SCORE_SCALE", kScoreScale);
  real("LEAST_CORNER_SCORE", kLeastCornerScore);
  whole("MOST_CELL_CORNERS", static_cast<int>(kMostCellCorners));
  return out.str() + kMatchSource;
}

}  // namespace coslam
