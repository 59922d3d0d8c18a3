// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/base/time.h"
#include "common/model/thumbnail.h"

namespace coslam {

// Small images of cameras while somebody looks at them: when to ask for one, and the newest that came. Images that
// nobody asked for are not kept, nor any for longer than 5 s. Pure: time is an argument. Thread-compatible.
class Thumbnails {
 public:
  // Notes that somebody looks at this agent's image now. True: one is to be asked for; once a second at most.
  bool look(const std::string& agent, Instant now);
  void add(Thumbnail thumbnail, Instant now);
  std::optional<Thumbnail> newest(const std::string& agent, Instant now) const;
  // Drops what is old.
  void tick(Instant now);

 private:
  struct Looked {
    Instant looked_at;
    std::optional<Instant> asked_at, came_at;
    Thumbnail thumbnail;
  };
  std::map<std::string, Looked> looked_;
};

}  // namespace coslam
