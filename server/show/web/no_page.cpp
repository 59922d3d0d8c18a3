// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/page.h"

namespace coslam {

std::span<const PageFile> page_files() { return {}; }

}  // namespace coslam
