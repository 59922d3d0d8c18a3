// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node build.mjs [--out DIR] [--modules DIR] [--cpp FILE]
//
// Bundles the page into DIR (default dist/): index.html, page.js, page.css, icon.svg. With --cpp also writes them as the
// bytes that server/web/page.h declares. --modules names a node_modules outside of this folder.
import { copyFileSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

import { cppOf } from "./bytes.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({
  options: {
    out: { type: "string", default: join(here, "dist") },
    modules: { type: "string", default: join(here, "node_modules") },
    cpp: { type: "string" },
  },
});
const modules = resolve(values.modules);
const out = resolve(values.out);

const { build } = createRequire(join(modules, "of-the-page.js"))("esbuild");
await build({
  absWorkingDir: here,
  entryPoints: { page: "src/main.ts", style: "src/style/page.css" },
  entryNames: "page",
  nodePaths: [modules],
  outdir: out,
  bundle: true,
  minify: true,
  format: "esm",
  target: ["es2022", "chrome109", "firefox115", "safari16"],
  legalComments: "none",
  logLevel: "warning",
});
mkdirSync(out, { recursive: true });
for (const name of ["index.html", "icon.svg"]) copyFileSync(join(here, "src", name), join(out, name));

if (values.cpp) {
  const names = readdirSync(out).filter((name) => /\.(html|js|css|svg)$/.test(name));
  const files = names.sort().map((name) => ({ name, bytes: readFileSync(join(out, name)) }));
  writeFileSync(values.cpp, cppOf(files));
}
