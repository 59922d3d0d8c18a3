// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/result_argument.h"

#include <cstdio>
#include <filesystem>

namespace coslam {

ResultFolder result_argument(const std::string& named) {
  ResultFolder result = find_result(named);
  if (!std::filesystem::exists(result.report())) {
    std::fprintf(stderr,
                 "coslam: warning: %s has no report.json, as of a server that was killed or is still at work: what "
                 "lies there is read\n",
                 result.path().c_str());
  }
  for (const auto& file : contents_of(result).missing) {
    std::fprintf(stderr, "coslam: warning: %s is not there, though the report lists it: its poses count as none\n",
                 file.c_str());
  }
  return result;
}

}  // namespace coslam
