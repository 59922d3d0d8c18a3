// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/lens_forms.h"

#include <algorithm>

namespace coslam {
namespace {

// How many coefficients a lens needs of its model.
std::size_t used_terms(const CameraModel& camera) {
  std::size_t n = lens_traits(camera.distortion).terms.size();
  while (n > 0 && camera.coefficients[n - 1] == 0) --n;
  return n;
}

std::optional<LensForm> shortest_form(LensFile file, DistortionModel model, std::size_t terms) {
  std::optional<LensForm> shortest;
  for (const LensForm& form : lens_traits(model).forms) {
    if (form.file != file || form.one_focal || form.terms < terms) continue;
    if (!shortest || form.terms < shortest->terms) shortest = form;
  }
  return shortest;
}

}  // namespace

std::optional<DistortionModel> lens_named(std::string_view name) {
  for (const DistortionModel model : kDistortionModels) {
    const auto& names = lens_traits(model).names;
    if (std::find(names.begin(), names.end(), name) != names.end()) return model;
  }
  return std::nullopt;
}

std::optional<NamedLens> lens_named(LensFile file, std::string_view name) {
  for (const DistortionModel model : kDistortionModels) {
    for (const LensForm& form : lens_traits(model).forms) {
      if (form.file == file && form.name == name) return NamedLens{model, form};
    }
  }
  return std::nullopt;
}

std::vector<std::string_view> lens_names(LensFile file) {
  std::vector<std::string_view> names;
  for (const DistortionModel model : kDistortionModels) {
    for (const LensForm& form : lens_traits(model).forms) {
      if (form.file == file && std::ranges::find(names, form.name) == names.end()) names.push_back(form.name);
    }
  }
  return names;
}

std::optional<LensForm> exact_form(LensFile file, const CameraModel& camera) {
  const auto form = shortest_form(file, camera.distortion, used_terms(camera));
  if (form || camera.distortion != DistortionModel::kNone) return form;
  return shortest_form(file, DistortionModel::kRadTan, 0);
}

std::size_t most_terms(LensFile file, DistortionModel model) {
  std::size_t most = 0;
  for (const LensForm& form : lens_traits(model).forms) {
    if (form.file == file) most = std::max(most, form.terms);
  }
  return most;
}

std::size_t coefficient_count(const CameraModel& camera) {
  const auto& counts = lens_traits(camera.distortion).counts;
  const std::size_t used = used_terms(camera);
  return *std::find_if(counts.begin(), counts.end(), [&](std::size_t count) { return count >= used; });
}

double focal_in_files(const CameraModel& camera) {
  return visit_lens(camera.distortion, [&](auto lens) { return lens.focal_in_files(camera.coefficients); });
}

}  // namespace coslam
