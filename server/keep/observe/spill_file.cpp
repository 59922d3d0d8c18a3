// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/keep/observe/spill_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "common/base/error.h"

namespace coslam {
namespace {

// Without a name from the start where the file system can do that.
int open_nameless(const std::filesystem::path& folder) {
  constexpr mode_t kMode = S_IRUSR | S_IWUSR;
  const int descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, kMode);
  if (descriptor >= 0) return descriptor;
  std::string name = (folder / ".past.XXXXXX").string();
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

std::string text_of(int error) { return std::generic_category().message(error); }

}  // namespace

SpillFile::~SpillFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

SpillFile::Ticket SpillFile::put(std::string octets) {
  const Ticket ticket = places_.size();
  places_.push_back({0, octets.size()});
  waiting_.emplace(ticket, std::move(octets));
  write_waiting();
  return ticket;
}

void SpillFile::write_waiting() {
  if (descriptor_ < 0) descriptor_ = open_nameless(folder_);
  while (!waiting_.empty()) {
    const auto& [ticket, octets] = *waiting_.begin();
    if (descriptor_ < 0 || !write(octets)) {
      if (!std::exchange(failing_, true)) {
        problem_ = "the older part of the run cannot be put to disk in " + folder_.string() + ": " + text_of(errno) +
                   "; mapping goes on, and it is kept in memory";
      }
      return;
    }
    places_[ticket].offset = end_;
    end_ += octets.size();
    waiting_.erase(waiting_.begin());
  }
  failing_ = false;
}

bool SpillFile::write(const std::string& octets) {
  for (std::size_t done = 0; done < octets.size();) {
    const ssize_t n = pwrite(descriptor_, octets.data() + done, octets.size() - done, static_cast<off_t>(end_ + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

std::string SpillFile::get(Ticket ticket) const {
  if (const auto at = waiting_.find(ticket); at != waiting_.end()) return at->second;
  const Place& place = places_.at(ticket);
  std::string octets(place.size, '\0');
  for (std::size_t done = 0; done < octets.size();) {
    const ssize_t n =
        pread(descriptor_, octets.data() + done, octets.size() - done, static_cast<off_t>(place.offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) throw UserError("the older part of the run in " + folder_.string() + " was cut off by somebody");
    if (n < 0)
      throw UserError("the older part of the run cannot be read back from " + folder_.string() + ": " + text_of(errno));
    done += static_cast<std::size_t>(n);
  }
  return octets;
}

std::optional<std::string> SpillFile::take_problem() { return std::exchange(problem_, std::nullopt); }

}  // namespace coslam
