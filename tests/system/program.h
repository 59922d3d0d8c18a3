// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <array>
#include <string>
#include <vector>

namespace coslam::test {

// One of the product's programs, run beside the test with its output caught; dies with the test.
class Program {
 public:
  // `name` is that of a file in the build's bin folder.
  Program(const std::string& name, std::vector<std::string> arguments);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  // Reads until its standard error, or output, holds the text. False when it ended, or took too long, without.
  bool says(const std::string& text) { return has(1, text); }
  bool says_again(const std::string& text) { return has(1, text, err().size()); }  // after what was read so far
  bool prints(const std::string& text) { return has(0, text); }
  // Waits until it and all that it started have ended. Its exit code; 128 + N after signal N, -1 when it took too long.
  int exit_code();
  void signal(int number) const;
  // The process that it started whose command line holds all these words; 0: none.
  pid_t child_with(const std::vector<std::string>& words) const;

  const std::string& out() const { return text_[0]; }
  const std::string& err() const { return text_[1]; }

 private:
  bool has(std::size_t stream, const std::string& text, std::size_t from = 0);
  bool read_more(int timeout_ms);

  pid_t pid_ = -1;
  std::array<int, 2> pipes_{-1, -1};  // standard output and error; -1: at its end
  std::array<std::string, 2> text_;
};

// The lines of a text that hold `part`.
std::vector<std::string> lines_with(const std::string& text, const std::string& part);

}  // namespace coslam::test
