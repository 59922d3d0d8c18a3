// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/model/rig.h"

namespace coslam {

class YamlValue;

// Reads one rig from YAML: the cameras behind the first one of
//   {cameras: [cam0, cam1, ...], cam_from_first: {cam1: [x, y, z, qx, qy, qz, qw], ...}}
//   {cameras: [cam0, cam1, ...], kalibr: camchain.yaml}      the i-th camera is cam<i> of the file (T_cn_cnm1)
// Paths are relative to the file that the rig stands in. Throws UserError with file, line and reason.
std::vector<RigCamera> read_rig(const YamlValue& rig);

// Reads a rig as texts, one per camera, each as text_of() writes it.
std::vector<std::string> read_rig_texts(const YamlValue& rig);

}  // namespace coslam
