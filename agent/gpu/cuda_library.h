// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>

namespace coslam {

// Shared library of CUDA, looked for when the program runs: it is there for the whole run, or not at all.
class CudaLibrary {
 public:
  // Opens the first of `names` that there is. Throws NoDevice, which calls the library by `title`.
  CudaLibrary(const char* title, std::initializer_list<const char*> names);

  // Sets a pointer to the function of this name. Throws NoDevice where the library has none.
  template <class F>
  void load(const char* name, F*& function) const {
    function = reinterpret_cast<F*>(symbol(name));
  }

 private:
  void* symbol(const char* name) const;

  const char* title_;
  void* handle_ = nullptr;
};

}  // namespace coslam
