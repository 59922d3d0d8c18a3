// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "common/geometry/camera_model.h"

namespace coslam {

// Lens model that calibration files call by this name as their distortion model; empty: none does.
std::optional<DistortionModel> lens_named(std::string_view name);

// Lens model that a kind of calibration files calls by this name, in its first form of that name; empty: none does.
struct NamedLens {
  DistortionModel model = DistortionModel::kNone;
  LensForm form;
};
std::optional<NamedLens> lens_named(LensFile file, std::string_view name);

// Names of lenses that such files have, each once.
std::vector<std::string_view> lens_names(LensFile file);

// Shortest form in which such files have the camera's lens exactly; empty: they have none. A lens without distortion
// is written as radtan of zeros where files have no name for it.
std::optional<LensForm> exact_form(LensFile file, const CameraModel& camera);

// Most coefficients of a model that such files have; 0 where they do not have the model.
std::size_t most_terms(LensFile file, DistortionModel model);

// Coefficients that a file of this product gives for the camera, as few as its model may have.
std::size_t coefficient_count(const CameraModel& camera);

// Focal length that files give for the camera's lens, over that of CameraModel.
double focal_in_files(const CameraModel& camera);

}  // namespace coslam
