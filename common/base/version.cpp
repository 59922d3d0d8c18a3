// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/base/version.h"

namespace coslam {

const char* version() { return COSLAM_VERSION; }

}  // namespace coslam
