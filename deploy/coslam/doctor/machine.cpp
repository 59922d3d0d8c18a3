// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/coslam/doctor/machine.h"

#include <algorithm>
#include <cmath>

#include "common/base/text.h"

namespace coslam::doctor {
namespace {

constexpr std::uint64_t kMebibyte = 1U << 20U, kGibibyte = 1U << 30U;

std::string in_mebibytes(std::uint64_t bytes) { return std::to_string(bytes / kMebibyte) + " MiB"; }

Finding judge_buffer(const std::string& key, std::uint64_t most, std::uint64_t wanted) {
  const std::string subject = "buffers";
  if (most == 0) return {Grade::kOk, subject, "net.core." + key + " is not told here"};
  const std::string has = "net.core." + key + " is " + std::to_string(most);
  if (most >= wanted) return {Grade::kOk, subject, has + ", enough for the " + std::to_string(wanted) + " asked for"};
  return {Grade::kWarn, subject,
          has + ", less than the " + std::to_string(wanted) + " asked for: many cameras at once overrun it",
          "sudo sysctl -w net.core." + key + "=" + std::to_string(wanted)};
}

}  // namespace

Findings judge(const ProcessorFacts& facts) {
  Findings out;
  const std::string cores = std::to_string(facts.cores) + (facts.cores == 1 ? " core" : " cores");
  const std::string load = cores + ", load " + format_tenths(facts.load);
  if (facts.load > facts.cores) {
    out.push_back({Grade::kWarn, "processor", load + ": other work takes what agents and server need", "top"});
  } else {
    out.push_back({Grade::kOk, "processor", load});
  }
  if (facts.governor == "powersave" || facts.governor == "conservative") {
    out.push_back({Grade::kWarn, "governor", "the processor is held at '" + facts.governor + "': images take longer",
                   "sudo cpupower frequency-set -g performance"});
  }
  out.push_back(
      {Grade::kOk, "GPU", facts.gpu ? "a driver offers one" : "none: an agent tracks on the processor, which is fine"});
  return out;
}

Findings judge(const EnvironmentFacts& facts) {
  Findings out{{Grade::kOk, "versions", facts.versions}};
  for (const std::string& name : facts.ignored) {
    out.push_back({Grade::kOk, "environment",
                   name + " is set: ROS 2 nodes follow it, the fleet goes by `wire` of its configuration alone"});
  }
  if (facts.ros_domain == facts.domain) {
    const std::string number = std::to_string(facts.domain);
    out.push_back({Grade::kWarn, "environment",
                   "ROS_DOMAIN_ID is " + number + ", the fleet's: nodes and fleet hear each other's announcements",
                   "--domain N with another number on all machines of the fleet"});
  }
  return out;
}

Findings judge(const SharedMemoryFacts& facts) {
  const std::string subject = "/dev/shm", fine = "; the fleet does not use it";
  if (!facts.exists || !facts.writable) {
    return {{Grade::kWarn, subject,
             std::string(facts.exists ? "cannot be written to" : "is not there") +
                 ": the fleet does not need it, ROS 2 nodes beside it do",
             facts.exists ? "sudo chmod 1777 /dev/shm" : "sudo mount -t tmpfs -o mode=1777 tmpfs /dev/shm"}};
  }
  Finding out{Grade::kOk, subject, in_mebibytes(facts.free_bytes) + " free" + fine};
  const bool full = facts.free_bytes < 16 * kMebibyte;
  if (facts.stale > 0) {
    out.found += "; " + std::to_string(facts.stale) + " of " + std::to_string(facts.segments) +
                 " segments of DDS processes are of such that are gone";
    out.mend = "fastdds shm clean";
  } else if (full) {
    out.mend = "ls -lS /dev/shm";
  }
  if (full || facts.stale > 20) out.grade = Grade::kWarn;
  return {out};
}

Findings judge(const BufferFacts& facts) {
  return {judge_buffer("rmem_max", facts.most_receive, facts.wanted_receive),
          judge_buffer("wmem_max", facts.most_send, facts.wanted_send)};
}

Findings judge(const DiskFacts& facts) {
  const std::string subject = "disk", free = in_mebibytes(facts.free_bytes) + " free for " + facts.folder;
  const std::string more_room = "--out DIR on another disk, or remove old results";
  if (facts.free_bytes < 64 * kMebibyte) return {{Grade::kFail, subject, free + ": it is full", more_room}};
  if (!facts.problem.empty()) {
    return {{Grade::kFail, subject, "nothing can be written to " + facts.folder + ": " + facts.problem,
             "--out DIR with a folder of this user"}};
  }
  if (facts.free_bytes < kGibibyte)
    return {{Grade::kWarn, subject, free + ": an hour of a few cameras needs more", more_room}};
  return {{Grade::kOk, subject, free}};
}

}  // namespace coslam::doctor
