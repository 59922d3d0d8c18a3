// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/system/program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace coslam::test {
namespace {

using Clock = std::chrono::steady_clock;

// Long enough for a machine under load; a program that is right never takes it.
constexpr std::chrono::seconds kLongest{40};

int ms_until(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
  return static_cast<int>(std::max<std::int64_t>(0, left.count()));
}

std::string contents(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

Program::Program(const std::string& name, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), std::string(COSLAM_BIN).append("/").append(name));
  std::vector<char*> argv;
  for (std::string& word : arguments) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::array<std::array<int, 2>, 2> ends{};
  for (auto& pair : ends) {
    if (pipe2(pair.data(), O_CLOEXEC) != 0) throw std::runtime_error("cannot make a pipe");
  }
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("cannot fork");
  if (pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(ends[0][1], STDOUT_FILENO);
    dup2(ends[1][1], STDERR_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    close(ends[i][1]);
    pipes_[i] = ends[i][0];
  }
}

Program::~Program() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  for (const int pipe : pipes_) {
    if (pipe >= 0) close(pipe);
  }
}

// False at the end of both streams, and when nothing came in time.
bool Program::read_more(int timeout_ms) {
  std::array<pollfd, 2> wanted{};
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = {pipes_[i], POLLIN, 0};  // negative ones are passed over
  if (std::ranges::all_of(pipes_, [](int pipe) { return pipe < 0; })) return false;
  if (poll(wanted.data(), wanted.size(), timeout_ms) <= 0) return false;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i].revents == 0) continue;
    std::array<char, 4096> part{};
    const ssize_t n = read(pipes_[i], part.data(), part.size());
    if (n > 0) {
      text_[i].append(part.data(), static_cast<std::size_t>(n));
    } else {
      close(std::exchange(pipes_[i], -1));
    }
  }
  return true;
}

bool Program::has(std::size_t stream, const std::string& text, std::size_t from) {
  const auto end = Clock::now() + kLongest;
  while (text_.at(stream).find(text, from) == std::string::npos) {
    if (!read_more(ms_until(end))) return false;
  }
  return true;
}

int Program::exit_code() {
  const auto end = Clock::now() + kLongest;
  while (read_more(ms_until(end))) {
  }
  if (pipes_[0] >= 0 || pipes_[1] >= 0) return -1;
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void Program::signal(int number) const { ::kill(pid_, number); }

pid_t Program::child_with(const std::vector<std::string>& words) const {
  const std::string of_main_thread = "/proc/" + std::to_string(pid_) + "/task/" + std::to_string(pid_) + "/children";
  std::istringstream children(contents(of_main_thread));
  for (pid_t child = 0; children >> child;) {
    const std::string command = contents("/proc/" + std::to_string(child) + "/cmdline");
    if (std::ranges::all_of(words, [&](const std::string& w) { return command.find(w) != std::string::npos; }))
      return child;
  }
  return 0;
}

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(part) != std::string::npos) found.push_back(line);
  }
  return found;
}

}  // namespace coslam::test
