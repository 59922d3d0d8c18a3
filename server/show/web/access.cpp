// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "server/show/web/access.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>

namespace coslam {
namespace {

// Takes as long whatever differs, so that time tells nothing of it.
bool equal_slowly(std::string_view a, std::string_view b) {
  unsigned differ = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char other = b.empty() ? '\0' : b[i % b.size()];
    differ |= static_cast<unsigned char>(a[i] ^ other);
  }
  return differ == 0;
}

}  // namespace

bool names_this_host(std::string_view host) {
  if (host.starts_with('[')) return host.substr(0, host.find(']')) == "[::1";
  const std::string_view name = host.substr(0, host.find(':'));
  return name == "localhost" || name == "127.0.0.1";
}

bool Access::granted(const Asked& asked) const { return token_.empty() ? is_from_here(asked) : knows_token(asked); }

bool Access::knows_token(const Asked& asked) const {
  constexpr std::string_view kBearer = "Bearer ";
  if (asked.authorization.starts_with(kBearer)) {
    return equal_slowly(asked.authorization.substr(kBearer.size()), token_);
  }
  return !asked.token.empty() && equal_slowly(asked.token, token_);
}

bool Access::is_from_here(const Asked& asked) const {
  if (!asked.host.empty() && !names_this_host(asked.host)) return false;
  if (asked.origin.empty() || std::ranges::find(origins_, asked.origin) != origins_.end()) return true;
  const std::size_t scheme = asked.origin.find("://");
  return scheme != std::string_view::npos && names_this_host(asked.origin.substr(scheme + 3));
}

std::string draw_token() {
  std::random_device device;
  std::string out;
  for (int i = 0; i < 4; ++i) {
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%08x", device());
    out += text.data();
  }
  return out;
}

}  // namespace coslam
