// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace coslam {

// A file of the page that the web server shows, held in the program.
struct PageFile {
  std::string_view name;      // relative to the page, with '/' between folders: "index.html", "assets/main.js"
  std::string_view type;      // value of Content-Type: "text/html; charset=utf-8"
  std::string_view encoding;  // value of Content-Encoding, "gzip"; empty: plain
  std::span<const std::uint8_t> bytes;
};

// All files of the page; `/` is index.html. Empty: this program was built without its page.
std::span<const PageFile> page_files();

}  // namespace coslam
