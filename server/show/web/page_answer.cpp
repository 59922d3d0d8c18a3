// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "server/show/web/answer.h"
#include "server/show/web/page.h"

namespace coslam {
namespace {

constexpr std::string_view kNoPage = R"(<!doctype html>
<html lang="en"><meta charset="utf-8"><title>CoSLAM</title>
<p>This program was built without its page, for which the build needs npm.
<p>What the page would show can be seen with Foxglove or Lichtblick: open a connection to this address as
<code>ws://</code>. For programs: <a href="/metrics">/metrics</a>, <a href="/healthz">/healthz</a>,
<a href="/readyz">/readyz</a>, <a href="/api/v1/agents">/api/v1/agents</a>,
<a href="/api/v1/groups">/api/v1/groups</a>, <a href="/api/v1/map.ply">/api/v1/map.ply</a>.
)";

}  // namespace

WebAnswer page_answer(std::string_view path) {
  const auto files = page_files();
  const std::string_view name = path == "/" ? "index.html" : path.substr(1);
  const auto file = std::ranges::find(files, name, &PageFile::name);
  if (file != files.end()) {
    const std::string_view body(reinterpret_cast<const char*>(file->bytes.data()), file->bytes.size());
    return {200, std::string(file->type), std::string(file->encoding), body, nullptr};
  }
  if (path == "/" && files.empty()) return {200, "text/html; charset=utf-8", "", kNoPage, nullptr};
  return plain_answer(404, "there is nothing at " + std::string(path));
}

}  // namespace coslam
