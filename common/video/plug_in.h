// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace coslam {

// A part of CoSLAM that is loaded when it is first needed: lib/coslam/plugins/NAME.so beside the folder of the program.
// Each exports coslam_plug_in(version), which gives an object that lasts as long as the program; null: it is of another
// version.
struct PlugIn {
  const void* object = nullptr;
  std::string why_not;  // a sentence without its end; where there is no object
};

// Loads what `use` needs ("videos are decoded by FFmpeg"). May be called from any thread.
PlugIn load_plug_in(const std::string& name, const std::string& use);

}  // namespace coslam
