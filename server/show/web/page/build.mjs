// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node build.mjs [--cpp FILE]
//
// Bundles the page into dist/: index.html, page.js, page.css, icon.svg, licences.txt. With --cpp also writes them as the
// bytes that server/show/web/page.h declares.
import { copyFileSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { build } from "esbuild";

import { cppOf } from "./bytes.mjs";
import { licencesOf } from "./licences.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const out = join(here, "dist");
const { values } = parseArgs({ options: { cpp: { type: "string" } } });

const { metafile } = await build({
  absWorkingDir: here,
  entryPoints: { page: "src/main.ts", style: "src/style/page.css" },
  entryNames: "page",
  outdir: out,
  bundle: true,
  minify: true,
  format: "esm",
  target: ["es2022", "chrome109", "firefox115", "safari16"],
  legalComments: "none",  // see licences.txt
  metafile: true,
  logLevel: "warning",
});
writeFileSync(join(out, "licences.txt"), licencesOf(here, Object.keys(metafile.inputs)));
for (const name of ["index.html", "icon.svg"]) copyFileSync(join(here, "src", name), join(out, name));

if (values.cpp) {
  const names = readdirSync(out).filter((name) => /\.(html|js|css|svg|txt)$/.test(name));
  const files = names.sort().map((name) => ({ name, bytes: readFileSync(join(out, name)) }));
  writeFileSync(values.cpp, cppOf(files));
}
