// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/fleet/link/thumbnails.h"

#include <chrono>
#include <utility>

namespace coslam {
namespace {

constexpr std::chrono::milliseconds kPeriod{1000}, kKept{5000};

}  // namespace

bool Thumbnails::look(const std::string& agent, Instant now) {
  Looked& looked = looked_[agent];
  looked.looked_at = now;
  if (looked.asked_at && now - *looked.asked_at < kPeriod) return false;
  looked.asked_at = now;
  return true;
}

void Thumbnails::add(Thumbnail thumbnail, Instant now) {
  const auto looked = looked_.find(thumbnail.agent);
  if (looked == looked_.end()) return;
  looked->second.came_at = now;
  looked->second.thumbnail = std::move(thumbnail);
}

std::optional<Thumbnail> Thumbnails::newest(const std::string& agent, Instant now) const {
  const auto looked = looked_.find(agent);
  if (looked == looked_.end() || !looked->second.came_at || now - *looked->second.came_at > kKept) return std::nullopt;
  return looked->second.thumbnail;
}

void Thumbnails::tick(Instant now) {
  std::erase_if(looked_, [now](const auto& entry) { return now - entry.second.looked_at > kKept; });
}

}  // namespace coslam
