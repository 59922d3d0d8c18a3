// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/geometry/lens_forms.h"

#include <algorithm>

namespace coslam {
namespace {

// Whether the enum has a name for this number, as compilers print it.
template <DistortionModel kModel>
constexpr bool has_name() {
  return std::string_view(__PRETTY_FUNCTION__).find("DistortionModel::k") != std::string_view::npos;
}

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kLensModels; ++i) {
    if (kDistortionModels[i] != static_cast<DistortionModel>(i)) return false;
  }
  return true;
}

// A name and a count each; those coefficients that are free or have typical values have names; forms have no more.
constexpr bool is_complete(const LensTraits& t) {
  if (t.names.size() == 0 || t.counts.size() == 0 || t.first_free > t.end_free) return false;
  const std::size_t most = t.counts.back();
  bool good = most == t.terms.size() && t.end_free <= most && most <= LensTerms().size();
  for (std::size_t i = most; i < t.typical.size(); ++i) good = good && t.typical[i] == 0;
  for (const LensForm& form : t.forms) good = good && form.terms <= most && form.before <= form.terms;
  return good;
}

constexpr bool are_complete() {
  for (const DistortionModel model : kDistortionModels) {
    if (!is_complete(lens_traits(model))) return false;
  }
  return true;
}

static_assert(is_in_order() && has_name<kLastDistortionModel>(), "LensModels follows the enum");
static_assert(!has_name<static_cast<DistortionModel>(kLensModels)>(), "a number of the enum has no lens model");
static_assert(are_complete(), "a lens model without names or counts, or with terms that have no name");

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
