// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/file.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/core/version.hpp>
#include <system_error>
#include <thread>

#include "agent/gpu/gpu_node.h"
#include "common/base/text.h"
#include "common/base/version.h"
#include "common/model/session.h"
#include "common/wire/participant.h"
#include "deploy/coslam/doctor/machine.h"

namespace coslam::doctor {
namespace {

// The first word of a file of the system; empty: there is none.
std::string word_in(const std::string& file) {
  std::string word;
  std::ifstream(file) >> word;
  return word;
}

std::uint64_t number_in(const std::string& file) {
  return static_cast<std::uint64_t>(parse_integer(word_in(file)).value_or(0));
}

std::uint64_t free_bytes(const std::string& folder) {
  struct statvfs disk {};
  return statvfs(folder.c_str(), &disk) == 0 ? std::uint64_t{disk.f_bavail} * disk.f_frsize : 0;
}

// A process of the middleware holds a lock on its segment's file as long as it lives.
bool is_stale(const std::filesystem::path& lock) {
  const int file = open(lock.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool stale = flock(file, LOCK_EX | LOCK_NB) == 0;
  close(file);
  return stale;
}

// Why no file can be made in it; empty: one can.
std::string why_not_writable(const std::string& folder) {
  std::string name = folder + "/.coslam-doctor-XXXXXX";
  const int file = mkstemp(name.data());
  if (file < 0) return std::generic_category().message(errno);
  std::string why;
  const std::string block(4096, 'x');
  if (write(file, block.data(), block.size()) < 0) why = std::generic_category().message(errno);
  close(file);
  unlink(name.c_str());
  return why;
}

// The folder, or the nearest one above it that is there: results make theirs.
std::filesystem::path nearest_folder(const std::filesystem::path& folder) {
  std::filesystem::path at = std::filesystem::absolute(folder);
  std::error_code ignored;
  while (!std::filesystem::exists(at, ignored) && at.has_relative_path()) at = at.parent_path();
  return at;
}

}  // namespace

ProcessorFacts look_at_processor() {
  ProcessorFacts facts;
  facts.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  facts.load = parse_double(word_in("/proc/loadavg")).value_or(0);
  const std::string frequency = "/sys/devices/system/cpu/cpu0/cpufreq/";
  // These drivers change the frequency by themselves, whatever they are called.
  const std::string driver = word_in(frequency + "scaling_driver");
  if (driver != "intel_pstate" && !driver.starts_with("amd-pstate"))
    facts.governor = word_in(frequency + "scaling_governor");
  facts.gpu = has_gpu_node();
  return facts;
}

EnvironmentFacts look_at_environment(int domain) {
  EnvironmentFacts facts;
  facts.domain = domain;
  for (const char* name : kIgnoredVariables) {
    if (std::getenv(name) != nullptr) facts.ignored.emplace_back(name);
  }
  if (const char* ros = std::getenv("ROS_DOMAIN_ID")) {
    if (const auto number = parse_integer(ros)) facts.ros_domain = static_cast<int>(*number);
  }
  facts.versions = std::string("CoSLAM ") + version() + ", protocol " + std::to_string(kProtocolVersion) +
                   ", Fast DDS " + middleware_version() + ", OpenCV " + CV_VERSION;
  return facts;
}

SharedMemoryFacts look_at_shared_memory(const std::string& folder) {
  SharedMemoryFacts facts;
  facts.exists = std::filesystem::is_directory(folder);
  if (!facts.exists) return facts;
  facts.writable = access(folder.c_str(), W_OK) == 0;
  facts.free_bytes = free_bytes(folder);
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const bool of_dds = name.starts_with("fastrtps_") || name.starts_with("fastdds_");  // up to Fast DDS 2, from 3 on
    if (!of_dds || !name.ends_with("_el")) continue;
    ++facts.segments;
    if (is_stale(entry.path())) ++facts.stale;
  }
  return facts;
}

BufferFacts look_at_buffers(std::uint64_t wanted_receive, std::uint64_t wanted_send) {
  return {number_in("/proc/sys/net/core/rmem_max"), number_in("/proc/sys/net/core/wmem_max"), wanted_receive,
          wanted_send};
}

DiskFacts look_at_disk(const std::string& folder) {
  const std::string existing_folder = nearest_folder(folder).string();
  return {folder, why_not_writable(existing_folder), free_bytes(existing_folder)};
}

}  // namespace coslam::doctor
