// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The licences of the packages that became part of a bundle, as they ask for.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";

const PACKAGE = /^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//;
const RULE = `\n${"-".repeat(80)}\n`;

// inputs: the files of the bundle, relative to `root`.
export function licencesOf(root, inputs) {
  const folders = new Set(inputs.map((input) => PACKAGE.exec(input)?.[1]).filter((folder) => folder !== undefined));
  const texts = [...folders].sort().map((folder) => {
    const { name, version, license, author } = JSON.parse(readFileSync(join(root, folder, "package.json"), "utf8"));
    const file = readdirSync(join(root, folder)).find((each) => /^(licen[cs]e|copying)/i.test(each));
    const text = file ? readFileSync(join(root, folder, file), "utf8").trim() : `${author?.name ?? author ?? ""}`;
    return `${name} ${version}: ${license}\n\n${text}\n`;
  });
  return `What this page is made of, beside CoSLAM itself (Apache-2.0)\n${RULE}${texts.join(RULE)}`;
}
