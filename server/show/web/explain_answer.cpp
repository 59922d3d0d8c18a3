// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/explain_answer.h"

#include <filesystem>

#include "common/base/error.h"
#include "common/base/text.h"

namespace coslam {
namespace {

constexpr std::uintmax_t kMostEvents = 64 << 20;  // octets of events.csv that are read for one answer

std::string of_query(const WebRequest& request, const std::string& key) {
  const auto at = request.query.find(key);
  return at == request.query.end() ? "" : at->second;
}

}  // namespace

std::optional<explain::Question> question_of(const WebRequest& request) {
  explain::Question question{of_query(request, "kind"), of_query(request, "id"), {}};
  const std::string at = of_query(request, "at");
  if (!at.empty()) question.at_s = parse_double(at);
  const bool known = question.kind == "point" || question.kind == "track" || question.kind == "camera";
  if (!known || question.id.empty() || (!at.empty() && !question.at_s)) return std::nullopt;
  return question;
}

WebAnswer no_question() { return plain_answer(400, "ask as ?kind=point|track|camera&id=ID[&at=SECONDS]"); }

WebAnswer explained(const ResultFolder& result, const explain::Question& question) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(result.events(), error);
  if (error) return plain_answer(404, "the run keeps no events.csv: nothing can be explained");
  if (bytes > kMostEvents)
    return plain_answer(503, "events.csv is too large to be read beside the mapping: coslam explain does that");
  try {
    return plain_answer(200, explain::answer(result, question).text);
  } catch (const UsageError& e) {
    return plain_answer(400, e.what());
  } catch (const UserError& e) {
    return plain_answer(404, e.what());
  }
}

}  // namespace coslam
