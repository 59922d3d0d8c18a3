// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace coslam::doctor {
namespace {

const char* word_of(Grade grade) {
  switch (grade) {
    case Grade::kFail:
      return "FAIL";
    case Grade::kWarn:
      return "warn";
    case Grade::kOk:
      break;
  }
  return "ok";
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(text.size(), width), ' ');
  return text;
}

std::string with_mend(const Finding& f) { return f.mend.empty() ? f.found : f.found + " -> " + f.mend; }

std::string counted(std::ptrdiff_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

}  // namespace

Grade worst_of(const Findings& findings) {
  const auto worst = std::ranges::max_element(findings, {}, &Finding::grade);
  return worst == findings.end() ? Grade::kOk : worst->grade;
}

std::string text_of(const Findings& findings) {
  std::size_t width = 0;
  for (const Finding& f : findings) width = std::max(width, f.subject.size());
  std::string text;
  for (const Finding& f : findings) {
    text += padded(word_of(f.grade), 4) + "  " + padded(f.subject, width) + "  " + with_mend(f) + "\n";
  }
  const Grade worst = worst_of(findings);
  if (worst == Grade::kOk) return text + "All is fine.\n";
  const auto first = std::ranges::find(findings, worst, &Finding::grade);
  return text + counted(std::ranges::count(findings, Grade::kFail, &Finding::grade), "fault") + ", " +
         counted(std::ranges::count(findings, Grade::kWarn, &Finding::grade), "warning") +
         ". First: " + first->subject + ": " + with_mend(*first) + "\n";
}

std::string json_of(const Findings& findings) {
  nlohmann::ordered_json all = nlohmann::json::array();
  for (const Finding& f : findings) {
    all.push_back({{"grade", word_of(f.grade)}, {"subject", f.subject}, {"found", f.found}, {"mend", f.mend}});
  }
  const nlohmann::ordered_json out{{"verdict", word_of(worst_of(findings))}, {"findings", all}};
  return out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace coslam::doctor
