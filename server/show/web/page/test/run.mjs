// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node test/run.mjs [--skip-code N]
//
// Checks the types, bundles the page and runs the tests. They need Node 20; those in a browser Debian's chromium. What is
// not there is said, its tests are left out, and the exit code is N (0 when not given) if the others pass.
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

import { CHROMIUM } from "./chromium.mjs";

const page = join(dirname(fileURLToPath(import.meta.url)), "..");
const { values } = parseArgs({ options: { "skip-code": { type: "string", default: "0" } } });

function leaveOut(what, why) {
  console.log(`skipped: ${what}, because ${why}`);
  process.exit(Number(values["skip-code"]));
}

function run(...command) {
  const { status } = spawnSync(process.execPath, command, { cwd: page, stdio: "inherit" });
  if (status !== 0) process.exit(status ?? 1);
}

const node = Number(process.versions.node.split(".")[0]);
if (node < 20) leaveOut("all tests of the page", `Node is ${process.versions.node}, and 20 is needed`);
if (!existsSync(join(page, "node_modules/typescript"))) leaveOut("all tests of the page", "its npm packages are not installed");
run("node_modules/typescript/bin/tsc", "--noEmit");
run("build.mjs");
const browser = existsSync(CHROMIUM);
const tests = ["test/values.test.mjs", ...(browser ? ["test/live.test.mjs", "test/states.test.mjs", "test/recorded.test.mjs"] : [])];
run("--test", "--test-concurrency=1", ...tests);
if (!browser) leaveOut("the tests in a browser", `there is no ${CHROMIUM} (Debian's package chromium)`);
