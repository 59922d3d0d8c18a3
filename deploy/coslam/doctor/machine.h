// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "deploy/coslam/doctor/finding.h"

// The machine itself: processor, memory that is shared, buffers of the kernel, variables, disk. Facts are looked up,
// judging them is pure.
namespace coslam::doctor {

struct ProcessorFacts {
  int cores = 1;
  double load = 0;       // processes that ran or waited, mean of the last minute
  std::string governor;  // frequency governor of the first core; empty: not told
  bool gpu = false;
};
ProcessorFacts look_at_processor();
Findings judge(const ProcessorFacts& facts);

struct EnvironmentFacts {
  std::vector<std::string> ignored;  // variables that are set and steer the middleware, not the fleet
  std::optional<int> ros_domain;     // domain of ROS 2 nodes that are started here
  int domain = 0;                    // domain of the fleet
  std::string versions;              // versions of the product and its libraries
};
EnvironmentFacts look_at_environment(int domain);
Findings judge(const EnvironmentFacts& facts);

struct SharedMemoryFacts {
  bool exists = false, writable = false;
  std::uint64_t free_bytes = 0;
  int segments = 0, stale = 0;  // segments of DDS processes; stale: of processes that have ended
};
SharedMemoryFacts look_at_shared_memory(const std::string& folder = "/dev/shm");
Findings judge(const SharedMemoryFacts& facts);

struct BufferFacts {
  std::uint64_t most_receive = 0, most_send = 0;  // limits of the kernel, octets; 0: not told
  std::uint64_t wanted_receive = 0, wanted_send = 0;
};
BufferFacts look_at_buffers(std::uint64_t wanted_receive, std::uint64_t wanted_send);
Findings judge(const BufferFacts& facts);

struct DiskFacts {
  std::string folder;   // folder as the user named it
  std::string problem;  // why nothing can be written there; empty: something can
  std::uint64_t free_bytes = 0;
};
DiskFacts look_at_disk(const std::string& folder);
Findings judge(const DiskFacts& facts);

}  // namespace coslam::doctor
