// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/video/plug_in.h"

#include <dlfcn.h>

#include <filesystem>

#include "common/base/version.h"

namespace coslam {

PlugIn load_plug_in(const std::string& name, const std::string& use) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path file = program.parent_path().parent_path() / "lib" / "coslam" / "plugins" / (name + ".so");
  const std::string package = use + ", which comes with the package " + name;
  if (error || !fs::exists(file, error)) return {nullptr, package + ", and that is not installed here"};
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return {nullptr, package + ", and that cannot be loaded: " + dlerror()};
  using Give = const void* (*)(const char* version);
  const auto give = reinterpret_cast<Give>(dlsym(library, "coslam_plug_in"));
  const void* object = give == nullptr ? nullptr : give(version());
  if (object == nullptr) return {nullptr, package + ", and that is of another version than this program"};
  return {object, {}};
}

}  // namespace coslam
