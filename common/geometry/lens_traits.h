// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

namespace coslam {

// Coefficients of a lens model in their order; those that it does not have are 0.
using LensTerms = std::array<double, 8>;

// Short list in a constant. More items than kMost do not compile there.
template <class T, std::size_t kMost>
class ShortList {
 public:
  constexpr ShortList() = default;
  constexpr ShortList(std::initializer_list<T> items) {
    for (const T& item : items) items_.at(size_++) = item;
  }
  constexpr std::size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr const T& operator[](std::size_t i) const { return items_[i]; }
  constexpr const T* begin() const { return items_.data(); }
  constexpr const T* end() const { return items_.data() + size_; }
  constexpr const T& front() const { return items_.front(); }
  constexpr const T& back() const { return items_[size_ - 1]; }

 private:
  std::array<T, kMost> items_{};
  std::size_t size_ = 0;
};

// Kinds of calibration files that have names of their own for lenses.
enum class LensFile : std::uint8_t { kOpenCv, kRos, kKalibr, kBasalt, kColmap, kOrbSlam, kDso };

// A lens model as one kind of files has it. A model may have several forms in one kind.
struct LensForm {
  LensFile file = LensFile::kOpenCv;
  std::string_view name;          // Kalibr: camera_model
  std::size_t terms = 0;          // coefficients that are given, from the first on; the rest are 0
  bool one_focal = false;         // COLMAP: one focal length for both axes; such a form is read alone
  std::size_t before = 0;         // Kalibr: coefficients that stand before fx among the intrinsics
  std::string_view distortion{};  // Kalibr: distortion_model
};

// Properties of a lens model beside its equations: what files, solvers and simulations ask.
struct LensTraits {
  ShortList<std::string_view, 4> names;                   // as `distortion_model` in files; the first is ours
  ShortList<std::string_view, LensTerms().size()> terms;  // names of the coefficients, which some files have as keys
  ShortList<std::size_t, 3> counts;                       // coefficients that a file may give, the fewest first
  std::size_t first_free = 0, end_free = 0;               // coefficients that a fit of the lens to images may change
  bool fisheye = false;                                   // shows rays far from the axis; else a wide field is a slip
  bool guess = false;                                     // the focal length is no calibration
  LensTerms typical{};                                    // coefficients of a usual lens: simulated cameras, tests
  ShortList<LensForm, 16> forms;                          // in each kind of files the first is written

  constexpr std::string_view name() const { return names.front(); }
};

}  // namespace coslam
