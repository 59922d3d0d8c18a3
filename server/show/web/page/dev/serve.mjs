// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node dev/serve.mjs [--port N] [--points N] [--whole] [--start S] [--record S | --server URL]
//
// Shows dist/ with a made-up run: --whole has all points at once, --record the run of S seconds as /api/v1/run.mcap.
// Or with the data of a server that runs: --server http://127.0.0.1:8080
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";

import { startMock } from "./mock.mjs";
import { startProxy } from "./proxy.mjs";
import { recordingOf } from "./record.mjs";

const { values } = parseArgs({
  options: {
    port: { type: "string", default: "8770" },
    points: { type: "string", default: "6000" },
    start: { type: "string", default: "0" },
    record: { type: "string" },
    server: { type: "string" },
    whole: { type: "boolean", default: false },
  },
});
const root = join(dirname(fileURLToPath(import.meta.url)), "..", "dist");
const port = Number(values.port);
if (values.server) {
  await startProxy({ root, port, server: values.server });
  console.log(`http://127.0.0.1:${port}/`);
} else {
  const points = Number(values.points);
  const recording = values.record ? await recordingOf({ seconds_s: Number(values.record), points }) : undefined;
  await startMock({ root, port, points, whole: values.whole, start_s: Number(values.start), recording });
  console.log(`http://127.0.0.1:${port}/${recording ? "?recorded" : ""}`);
}
