// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "common/dataset/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "common/base/error.h"

namespace coslam {
namespace {

constexpr std::size_t kBuffer_bytes = 1U << 16U, kMostKept_bytes = 1U << 24U;
constexpr std::chrono::seconds kTryAgain{1};

std::string cannot_write(const std::filesystem::path& file, int error) {
  const std::string cause = error == 0 ? "" : ": " + std::generic_category().message(error);
  return file.string() + ": cannot be written" + cause;
}

// The error, 0 for none.
int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(descriptor, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : EIO;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
}

}  // namespace

std::ofstream create_file(const std::filesystem::path& file, std::ios::openmode mode) {
  std::error_code error;  // where the folder cannot be made; else opening the file shows why
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  errno = 0;
  std::ofstream stream(file, mode | std::ios::out);
  if (!stream) throw UserError(cannot_write(file, error ? error.value() : errno));
  return stream;
}

void close_file(std::ofstream& stream, const std::filesystem::path& file) {
  errno = 0;
  stream.close();
  if (!stream) throw UserError(cannot_write(file, errno));
}

std::string what_becomes_of(bool ended) {
  return std::string("; mapping goes on, ") + (ended ? "the file ends here" : "what is not written is kept");
}

OutputFile::OutputFile(std::filesystem::path file, Shows shows)
    : file_(std::move(file)),
      opened_(shows == Shows::kWhole ? std::filesystem::path(file_.string() + ".new") : file_),
      shows_(shows) {
  std::error_code error;  // where the folder cannot be made; else opening the file shows why
  if (file_.has_parent_path()) std::filesystem::create_directories(file_.parent_path(), error);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC;
  constexpr mode_t kMode = 0666;  // less the umask
  descriptor_ = ::open(opened_.c_str(), kFlags, kMode);
  if (descriptor_ < 0) throw UserError(cannot_write(file_, error ? error.value() : errno));
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  if (shows_ == Shows::kAtOnce) write_out();
  ::close(descriptor_);
  if (shows_ == Shows::kWhole) ::unlink(opened_.c_str());
}

void OutputFile::write(std::string_view text) {
  if (ended_) return;
  buffer_ += text;
  if (buffer_.size() >= kBuffer_bytes) flush();
}

void OutputFile::flush() {
  if (problem_.empty() || std::chrono::steady_clock::now() - tried_ >= kTryAgain) write_out();
}

void OutputFile::write_out() {
  if (ended_ || buffer_.empty()) return;
  if (const int error = write_all(descriptor_, buffer_); error != 0) {
    fail(error);
    // A part of a line would make the rest unreadable. When this fails too there is nothing that helps.
    [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(written_));
    if (buffer_.size() < kMostKept_bytes) return;
    ended_ = true;
    reported_ = false;
  } else {
    written_ += buffer_.size();
    problem_.clear();
    reported_ = false;
  }
  buffer_.clear();
}

void OutputFile::fail(int error) {
  if (problem_.empty()) problem_ = cannot_write(file_, error);
  tried_ = std::chrono::steady_clock::now();
}

void OutputFile::cut(std::uintmax_t bytes) {
  if (ended_) return;
  if (bytes >= written_) return buffer_.resize(std::min(buffer_.size(), static_cast<std::size_t>(bytes - written_)));
  buffer_.clear();
  if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) {
    fail(errno);
  } else {
    written_ = bytes;
  }
}

std::optional<std::string> OutputFile::take_problem() {
  if (problem_.empty() || std::exchange(reported_, true)) return std::nullopt;
  return problem_;
}

void OutputFile::check() {
  write_out();
  if (!problem_.empty()) throw UserError(problem_);
}

void OutputFile::close() {
  if (descriptor_ < 0) return;
  write_out();
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);
  if (shows_ == Shows::kWhole) {
    if (problem_.empty() && std::rename(opened_.c_str(), file_.c_str()) != 0) fail(errno);
    if (!problem_.empty()) ::unlink(opened_.c_str());
  }
  if (!problem_.empty()) throw UserError(problem_);
}

}  // namespace coslam
