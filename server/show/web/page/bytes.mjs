// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The files of the page as the C++ source that answers server/show/web/page.h.
import { gzipSync } from "node:zlib";

const TYPES = {
  html: "text/html; charset=utf-8",
  js: "text/javascript; charset=utf-8",
  css: "text/css; charset=utf-8",
  svg: "image/svg+xml",
  txt: "text/plain; charset=utf-8",
};

function arrayOf(index, bytes) {
  const rows = [];
  for (let at = 0; at < bytes.length; at += 32) rows.push(bytes.subarray(at, at + 32).join(","));
  return `constexpr std::uint8_t kBytes${index}[] = {\n${rows.join(",\n")}};\n`;
}

// files: [{name, bytes}]; what they hold is compressed.
export function cppOf(files) {
  const packed = files.map(({ name, bytes }) => ({ name, bytes: gzipSync(bytes, { level: 9 }) }));
  const rows = packed.map(({ name }, index) => {
    const type = TYPES[name.split(".").pop()];
    return `    {"${name}", "${type}", "gzip", kBytes${index}},\n`;
  });
  return [
    "// Made by server/show/web/page/build.mjs.\n",
    '#include "server/show/web/page.h"\n\n',
    "namespace coslam {\nnamespace {\n\n",
    ...packed.map(({ bytes }, index) => arrayOf(index, bytes)),
    `\nconstexpr PageFile kFiles[] = {\n${rows.join("")}};\n\n}  // namespace\n\n`,
    "std::span<const PageFile> page_files() { return kFiles; }\n\n}  // namespace coslam\n",
  ].join("");
}
