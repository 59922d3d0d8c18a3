// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What needs no browser: messages, recordings' index, lives, frames.
import assert from "node:assert/strict";
import { test } from "node:test";
import { build } from "esbuild";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

import { Program } from "../dev/channels.mjs";
import { CdrWriter } from "../dev/cdr.mjs";
import { Run } from "../dev/messages.mjs";

async function load(contents) {
  const { outputFiles } = await build({ stdin: { contents, resolveDir: "src", loader: "ts" }, bundle: true, format: "esm", write: false });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].text).toString("base64")}`);
}

const { readCloud, column, parseLife, eigen, Frames, roundLength, History, clock } = await load(`
  export { readCloud, column } from "./data/cloud";
  export { parseLife } from "./data/explain";
  export { History } from "./data/history";
  export { eigen } from "./scene/selection";
  export { Frames } from "./scene/frames";
  export { roundLength } from "./scene/surroundings";
  export { clock } from "./ui/dom";`);

test("a cloud reads as a reader that is not ours reads it", () => {
  for (const whole of [false, true]) {  // rows of 27 and of 28 octets
    const program = new Program(new Run({ points: 500, whole }), 3);
    const channel = program.channels.find(({ topic }) => topic === "/coslam/map/points");
    const octets = channel.make(program.run, 3);
    const theirs = new MessageReader(parse(channel.schema, { ros2: true })).readMessage(octets);
    const ours = readCloud(octets);
    assert.equal(ours.frame, theirs.header.frame_id);
    assert.equal(ours.count, theirs.width);
    const view = new DataView(theirs.data.buffer, theirs.data.byteOffset, theirs.data.byteLength);
    const [sigma, views] = [new Float32Array(ours.count), new Uint16Array(ours.count)];
    assert.ok(column(ours, "sigma", sigma) && column(ours, "views", views) && !column(ours, "colour", views));
    for (let i = 0; i < ours.count; ++i) {
      assert.equal(sigma[i], view.getFloat32(i * theirs.point_step + 12, true));
      assert.equal(views[i], view.getUint16(i * theirs.point_step + 25, true));
    }
  }
});

test("a cloud that is cut off is refused, one without points is not", () => {
  const empty = new CdrWriter().header(1, "map").u32(1).u32(0).u32(0).u8(0).u32(16).u32(0).u32(0).u8(1).done();
  assert.equal(readCloud(empty).count, 0);
  assert.throws(() => readCloud(empty.slice(0, 24)), RangeError);
});

test("a life has its entries, notes and covariance", () => {
  const life = parseLife("point 4, in seconds of the run\n     0.633 s  It was made.\n    12.000 s  It moved.\npoints.csv has it.\ncovariance 1e-3 0 0 2e-3 0 .003\n");
  assert.deepEqual(life.entries, [{ t_s: 0.633, text: "It was made." }, { t_s: 12, text: "It moved." }]);
  assert.deepEqual(life.notes, ["points.csv has it."]);
  assert.deepEqual(life.covariance, [0.001, 0, 0, 0.002, 0, 0.003]);
});

test("axes of a covariance", () => {
  const { values, vectors } = eigen([2, 1, 0, 1, 2, 0, 0, 0, 5]);
  assert.deepEqual(values.map((value) => Number(value.toFixed(9))).sort(), [1, 3, 5]);
  const at = values.findIndex((value) => Math.abs(value - 3) < 1e-9);
  assert.ok(Math.abs(Math.abs(vectors[at].x) - Math.SQRT1_2) < 1e-9 && Math.abs(vectors[at].x - vectors[at].y) < 1e-9);
});

test("up is up for cameras that look down while they turn", () => {
  // Pitched by 0.5 rad about their x axes, which stay level; the map's own axes are those of a camera.
  const poses = Array.from({ length: 20 }, (_, i) => {
    const [yaw, pitch] = [0.3 * i, -0.5];
    const [cy, sy, cp, sp] = [Math.cos(yaw / 2), Math.sin(yaw / 2), Math.cos(pitch / 2), Math.sin(pitch / 2)];
    const camera = [cy * sp, sy * cp, -sy * sp, cy * cp];
    const [x, y, z, w] = [[1, 1, 1, 1], [-1, 1, 1, -1], [-1, -1, 1, 1], [-1, 1, -1, 1]]  // by a body's axes
      .map((signs) => 0.5 * signs.reduce((sum, sign, k) => sum + sign * camera[k], 0));
    return { position: { x: 0, y: 0, z: 0 }, orientation: { x, y, z, w } };
  });
  const frames = new Frames();
  frames.level("map", poses);
  const up = { x: 0, y: -1, z: 0 };
  const { turned } = frames.of("map");
  const [x, y, z, w] = turned.toArray();
  const turnedUp = 2 * (y * w * 0 + (x * y + z * w) * up.x) + (1 - 2 * (x * x + z * z)) * up.y + 2 * (y * z - x * w) * up.z;
  assert.ok(turnedUp > 0.999, `up leans: ${turnedUp}`);
});

test("the past stays in bounded memory, less finely", () => {
  const history = new History();
  const channel = {};
  for (let i = 0; i < 60000; ++i) history.add({ topic: "/coslam/state", t_s: i / 10, data: new Uint8Array(2000), channel });
  assert.ok(history.bytes() < 50e6);
  assert.equal(history.last("/coslam/state", 5999.95).t_s, 5999.9);
  assert.ok(5 < 100 && Math.abs(history.last("/coslam/state", 100).t_s - 100) < 20);
  assert.equal(history.last("/coslam/state", -1), undefined);
  const recent = history.between("/coslam/state", 5990, 6000);
  assert.equal(recent.length, 99);
});

test("lengths and times as people read them", () => {
  assert.deepEqual([0.7, 1, 3, 12, 0.03].map((value) => Number(roundLength(value).toPrecision(6))), [1, 1, 5, 20, 0.05]);
  assert.deepEqual([0, 62.44, 3723.4].map(clock), ["0:00.0", "1:02.4", "1:02:03.4"]);
});
