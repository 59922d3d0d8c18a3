// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/fuzzer.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "common/base/error.h"

namespace coslam::fuzz {

std::filesystem::path file_of(std::string_view content) {
  static const int file = memfd_create("fuzz", 0);
  const bool written = file >= 0 && ftruncate(file, 0) == 0 &&
                       pwrite(file, content.data(), content.size(), 0) == static_cast<ssize_t>(content.size());
  if (!written) std::abort();
  return "/proc/self/fd/" + std::to_string(file);
}

}  // namespace coslam::fuzz

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  const char* folder = std::getenv("COSLAM_FUZZ_SEEDS");
  if (folder == nullptr) return 0;
  coslam::fuzz::write_seeds([&](const std::string& name, std::string_view octets) {
    std::ofstream(std::filesystem::path(folder) / name, std::ios::binary) << octets;
  });
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    coslam::fuzz::try_octets({data, size});
  } catch (const coslam::UserError&) {
    // As it should be.
  }
  return 0;
}
