// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace coslam {

// Decides who may read: with a token, whoever knows it. Without one the server listens on this host alone, and the
// remaining risk is a browser on this host that shows a page from elsewhere: such a page names its origin in Origin, or
// in Host when it had its own name resolved to this host.
class Access {
 public:
  Access(std::string token, std::vector<std::string> origins)
      : token_(std::move(token)), origins_(std::move(origins)) {}

  struct Asked {
    std::string_view host, origin, authorization;  // headers; empty: absent
    std::string_view token;                        // parameter of the query
  };
  bool granted(const Asked& asked) const;

 private:
  bool knows_token(const Asked& asked) const;
  bool is_from_here(const Asked& asked) const;

  std::string token_;
  std::vector<std::string> origins_;
};

// "127.0.0.1", "::1", "localhost", in a Host header with or without a port.
bool names_this_host(std::string_view host);

// 128 random bits in hexadecimal.
std::string draw_token();

}  // namespace coslam
