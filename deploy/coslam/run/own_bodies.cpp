// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/own_bodies.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "agent/track/mask.h"
#include "common/base/error.h"
#include "common/base/log.h"
#include "common/dataset/result.h"
#include "common/dataset/result_folder.h"
#include "common/image/image_file.h"

namespace coslam {
namespace {

// Of cells by rows, '1' where something is left out.
cv::Mat mask_of(const nlohmann::json& body, cv::Size size) {
  const int columns = body["columns"].get<int>(), rows = body["rows"].get<int>();
  const auto cells = body["cells"].get<std::string>();
  if (columns < 1 || rows < 1 || cells.size() != static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {
    return {};
  }
  cv::Mat coarse(rows, columns, CV_8UC1), mask;
  std::ranges::transform(cells, coarse.begin<std::uint8_t>(), [](char c) { return c == '1' ? 0 : 255; });
  cv::resize(coarse, mask, size, 0, 0, cv::INTER_NEAREST);
  return mask;
}

}  // namespace

bool OwnBodies::improve(const std::filesystem::path& result) {
  const ResultFolder folder(result);
  if (!std::filesystem::exists(folder.report())) return false;
  const nlohmann::json report = read_json(folder.report());
  for (const SequenceAgent& agent : sequence_.agents) {
    const nlohmann::json& agent_report = report["agents"].value(agent.name, nlohmann::json::object());
    if (!agent_report.contains("own_body")) continue;
    const nlohmann::json& camera = agent_report["camera"];
    cv::Mat mask = mask_of(agent_report["own_body"], {camera["width_px"].get<int>(), camera["height_px"].get<int>()});
    if (mask.empty()) continue;
    if (agent.mask) {
      const cv::Mat given = read_mask(agent.mask->string());
      if (given.size() == mask.size()) mask &= given;
    }
    masks_[agent.name] = mask;
  }
  return !masks_.empty();
}

void OwnBodies::write(const std::filesystem::path& result) {
  for (SequenceAgent& agent : sequence_.agents) {
    const auto found = masks_.find(agent.name);
    if (found == masks_.end()) continue;
    const std::filesystem::path file = std::filesystem::absolute(ResultFolder(result).own_body(agent.name));
    std::filesystem::create_directories(file.parent_path());
    if (!write_image_file(file, found->second)) throw UserError("cannot write " + file.string());
    agent.mask = file;
  }
}

}  // namespace coslam
