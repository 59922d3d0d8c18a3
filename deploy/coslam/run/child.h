// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace coslam {

// A child process whose standard output can be read line by line without blocking. Killed if it still runs at the end,
// and asked to end when this process is killed.
class Child {
 public:
  // Throws UserError when the program cannot be started.
  Child(std::string name, const std::vector<std::string>& command);
  Child(Child&& other) noexcept;
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child& operator=(Child&&) = delete;
  ~Child();

  const std::string& name() const { return name_; }
  // Whether it has ended; then problem() says what was wrong with that, empty for exit code 0.
  bool ended();
  const std::string& problem() const { return problem_; }
  bool killed() const { return killed_; }  // ended by a signal, without a message of its own
  void interrupt() const;                  // SIGINT: end cleanly
  void kill() const;

  // Complete lines that came since the last call.
  std::vector<std::string> lines();

 private:
  std::string name_;
  pid_t pid_ = -1;
  int output_ = -1;
  bool ended_ = false, killed_ = false;
  std::string problem_;
  std::string partial_;
};

// Absolute path of a program beside this one.
std::string sibling_program(const std::string& name);

}  // namespace coslam
