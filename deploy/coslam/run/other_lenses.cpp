// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/other_lenses.h"

#include <cmath>

#include "common/base/log.h"
#include "common/base/printed.h"
#include "common/dataset/result.h"
#include "common/dataset/result_folder.h"

namespace coslam {

bool leave_other_lenses(Sequence* sequence, const std::filesystem::path& result) {
  constexpr double kOther = 0.22;  // the logarithm of a quarter more
  const ResultFolder folder(result);
  if (!std::filesystem::exists(folder.report())) return false;
  const nlohmann::json report = read_json(folder.report());
  bool any = false;
  for (SequenceAgent& agent : sequence->agents) {
    const auto ratio =
        report.value(nlohmann::json::json_pointer("/agents/" + agent.name + "/lens/focal_ratio"), nlohmann::json());
    if (agent.calibration.empty() || !ratio.is_number() || !(ratio.get<double>() > 0)) continue;
    if (std::abs(std::log(ratio.get<double>())) < kOther) continue;
    log_warn(
        printed("the images of agent %s fit a focal length of %.2g times that of %s, which is left aside: is it of "
                "another camera, or of images of another size?",
                agent.name.c_str(), ratio.get<double>(), agent.calibration.c_str()));
    agent.calibration.clear();
    any = true;
  }
  return any;
}

}  // namespace coslam
