// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/run/child.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/base/error.h"

namespace coslam {

Child::Child(std::string name, const std::vector<std::string>& command) : name_(std::move(name)) {
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC | O_NONBLOCK) != 0)
    throw UserError("cannot make a pipe: " + std::string(std::strerror(errno)));
  std::vector<std::string> words = command;
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    // Only system calls here. Without its parent it is to end as when asked to, the result written.
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    setpgid(0, 0);  // Ctrl-C on a terminal reaches it once, from here
    dup2(pipe_ends[1], STDOUT_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  ::close(pipe_ends[1]);
  output_ = pipe_ends[0];
  if (pid_ < 0) throw UserError("cannot start " + command.front() + ": " + std::strerror(errno));
}

Child::Child(Child&& other) noexcept
    : name_(std::move(other.name_)),
      pid_(std::exchange(other.pid_, -1)),
      output_(std::exchange(other.output_, -1)),
      ended_(other.ended_),
      killed_(other.killed_),
      problem_(std::move(other.problem_)),
      partial_(std::move(other.partial_)) {}

Child::~Child() {
  if (pid_ > 0 && !ended()) {
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (output_ >= 0) ::close(output_);
}

bool Child::ended() {
  if (ended_ || pid_ <= 0) return true;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return false;
  ended_ = true;
  killed_ = WIFSIGNALED(status);
  if (killed_) problem_ = name_ + " was killed by signal " + std::to_string(WTERMSIG(status));
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0)
    problem_ = name_ + " ended with exit code " + std::to_string(WEXITSTATUS(status));
  return true;
}

void Child::interrupt() const {
  if (!ended_ && pid_ > 0) ::kill(pid_, SIGINT);
}

void Child::kill() const {
  if (!ended_ && pid_ > 0) ::kill(pid_, SIGKILL);
}

std::vector<std::string> Child::lines() {
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = ::read(output_, buffer.data(), buffer.size())) > 0;)
    partial_.append(buffer.data(), static_cast<std::size_t>(n));
  std::vector<std::string> out;
  for (std::size_t end = 0; (end = partial_.find('\n')) != std::string::npos; partial_.erase(0, end + 1))
    out.push_back(partial_.substr(0, end));
  return out;
}

std::string sibling_program(const std::string& name) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path program = self.parent_path() / name;
  if (error || !std::filesystem::exists(program))
    throw UserError("the program " + program.string() + " is missing: build or install it too");
  return program.string();
}

}  // namespace coslam
