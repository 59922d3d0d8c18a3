// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/mcap_file.h"

#include "common/base/error.h"
#include "common/base/log.h"

namespace coslam {
namespace {

const std::filesystem::path& new_file(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) throw UserError(file.string() + ": is there already: name another file");
  return file;
}

}  // namespace

McapFile::McapFile(const std::filesystem::path& file)
    : file_(new_file(file), OutputFile::Shows::kAtOnce),
      sink_([this](std::string_view octets) { file_.write(octets); }) {}

McapFile::~McapFile() {
  sink_.close();
  file_.flush();
  say_problem();
}

void McapFile::put(const MessagePtr& message) {
  constexpr std::chrono::seconds kPeriod{1};  // so much is lost when the server is killed
  sink_.put(message);
  const auto now = std::chrono::steady_clock::now();
  if (now - flushed_ < kPeriod) return;
  flushed_ = now;
  sink_.flush();
  file_.flush();
  say_problem();
}

void McapFile::say_problem() {
  if (const auto problem = file_.take_problem()) log_warn(*problem + what_becomes_of(file_.ended()));
}

}  // namespace coslam
