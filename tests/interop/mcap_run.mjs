// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node mcap_run.mjs FILE AGENT...: a run that `coslam export --format mcap` wrote, as programs of others read it. All
// messages are decoded; those of ROS 2's own packages by ROS 2's definitions too.
import assert from "node:assert/strict";
import { Recording } from "./mcap.mjs";

const [file, ...agents] = process.argv.slice(2);
const recording = await Recording.open(file);
const { reader } = recording;
const start = reader.statistics.messageStartTime;
const end = reader.statistics.messageEndTime;
assert.ok(end > start, "it takes some time");

const count = new Map();
const frames = new Set();
let checked = 0;
let before = start;
for await (const { topic, t, value, independent } of recording.messages()) {
  assert.ok(t >= before, "by time");
  before = t;
  count.set(topic, (count.get(topic) ?? 0) + 1);
  if (independent) ++checked;
  if (topic === "/tf") for (const { child_frame_id } of value.transforms) frames.add(child_frame_id);
}
assert.equal(BigInt([...count.values()].reduce((a, b) => a + b)), reader.statistics.messageCount);
for (const agent of agents) {
  for (const frame of ["odom", "base_link", "camera_optical_frame"]) {
    assert.ok(frames.has(`${agent}/${frame}`), `/tf has ${agent}/${frame}`);
  }
  for (const topic of ["pose", "odom"]) assert.ok(count.get(`/coslam/${agent}/${topic}`) > 0, `${agent} has its ${topic}`);
  assert.ok(count.get(`/coslam/${agent}/path`) > 0, `${agent} has a path`);
  assert.ok(count.get(`/coslam/${agent}/tracks`) > 0, `${agent} has tracks`);
}
for (const topic of ["/tf", "/coslam/map/points", "/coslam/state", "/coslam/events"]) {
  assert.ok(count.get(topic) > 0, topic);
}

// The map grows: points show when they were first seen.
const widths = [];
for await (const { value } of recording.messages({ topics: ["/coslam/map/points"] })) widths.push(value.width);
assert.deepEqual(widths, [...widths].sort((a, b) => a - b));
assert.ok(widths.at(-1) > 0);

// A seek finds the instant without reading what is before it.
const half = (start + end) / 2n;
for await (const { t, value } of recording.messages({ topics: [`/coslam/${agents[0]}/odom`], startTime: half })) {
  assert.ok(t >= half && t < half + 500_000_000n);
  assert.equal(BigInt(value.header.stamp.sec) * 1_000_000_000n + BigInt(value.header.stamp.nanosec), t);
  break;
}

console.log(`mcap_run: ${reader.statistics.messageCount} messages, ${checked} checked by ROS 2's definitions, ` +
  `${widths.at(-1)} points, ${Number(end - start) / 1e9} s`);
for (const [topic, n] of [...count].sort()) console.log(`  ${topic} ${n}`);
