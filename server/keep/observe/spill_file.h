// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace coslam {

// Takes data out of memory while the process lives, into a file without a name that vanishes with the process. Data
// that cannot be written, as on a full disk, stays in memory and is tried again. The file is made at the first use.
// Thread-compatible.
class SpillFile {
 public:
  using Ticket = std::size_t;

  explicit SpillFile(std::filesystem::path folder) : folder_(std::move(folder)) {}
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  Ticket put(std::string octets);
  // Throws UserError when it cannot be read.
  std::string get(Ticket ticket) const;
  // Sentence with the cause, once for each time that writing failed.
  std::optional<std::string> take_problem();

 private:
  struct Place {
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
  };
  void write_waiting();
  bool write(const std::string& octets);

  std::filesystem::path folder_;
  int descriptor_ = -1;
  std::uint64_t end_ = 0;
  std::vector<Place> places_;  // indexed by ticket
  std::map<Ticket, std::string> waiting_;
  bool failing_ = false;
  std::optional<std::string> problem_;
};

}  // namespace coslam
