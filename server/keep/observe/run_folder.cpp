// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/run_folder.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "common/base/error.h"
#include "common/base/text.h"
#include "common/dataset/result_folder.h"

namespace coslam {
namespace {

[[noreturn]] void cannot_make(const std::filesystem::path& folder, const std::error_code& error) {
  throw UserError("cannot make the result folder " + folder.string() + ": " + error.message());
}

}  // namespace

std::string run_folder_name(TimeNs utc_ns, RunId run) {
  return format_utc(utc_ns, "%Y%m%dT%H%M%SZ-") + format_hex(run.value);
}

void make_folder_of_runs(const std::filesystem::path& runs) {
  std::error_code error;
  std::filesystem::create_directories(runs, error);
  if (!error && access(runs.c_str(), W_OK | X_OK) != 0) error.assign(errno, std::generic_category());
  if (error) cannot_make(runs, error);
}

std::filesystem::path make_run_folder(const std::filesystem::path& runs, TimeNs utc_ns, RunId run) {
  std::filesystem::path folder = runs / run_folder_name(utc_ns, run);
  std::error_code error;
  const bool made = std::filesystem::create_directory(folder, error);
  if (!made && !error) error = std::make_error_code(std::errc::file_exists);
  if (error) cannot_make(folder, error);
  return folder;
}

void link_latest(const std::filesystem::path& run_folder) {
  const std::filesystem::path link = run_folder.parent_path() / kLatestRun;
  const std::filesystem::path fresh = run_folder.string() + ".link";
  std::error_code error;
  std::filesystem::create_symlink(run_folder.filename(), fresh, error);
  if (!error) std::filesystem::rename(fresh, link, error);
  if (!error) return;
  std::error_code ignored;
  std::filesystem::remove(fresh, ignored);
  throw UserError("cannot let " + link.string() + " name the newest run: " + error.message());
}

}  // namespace coslam
