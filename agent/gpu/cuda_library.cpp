// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "agent/gpu/cuda_library.h"

#include <dlfcn.h>

#include <string>

#include "agent/gpu/device.h"

namespace coslam {

CudaLibrary::CudaLibrary(const char* title, std::initializer_list<const char*> names) : title_(title) {
  for (const char* name : names) {
    if (handle_ == nullptr) handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  }
  if (handle_ == nullptr) throw NoDevice(std::string("CUDA's ") + title + " is not installed");
}

void* CudaLibrary::symbol(const char* name) const {
  void* found = dlsym(handle_, name);
  if (found == nullptr) throw NoDevice(std::string("CUDA's ") + title_ + " is too old: it has no " + name);
  return found;
}

}  // namespace coslam
