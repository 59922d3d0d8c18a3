// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What needs no browser: messages, recordings' index, lives, frames.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
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

const { readCloud, column, parseLife, eigen, Frames, roundLength, History, clock, Figures, Chronicle, causeOf, pathSentence, worstPath, noticeOf, plyOf, distanceOf } = await load(`
  export { readCloud, column } from "./data/cloud";
  export { parseLife } from "./data/explain";
  export { Figures } from "./data/figures";
  export { Chronicle } from "./data/chronicle";
  export { causeOf } from "./data/cause";
  export { pathSentence, worstPath } from "./data/quality";
  export { noticeOf } from "./ui/notice";
  export { plyOf } from "./save";
  export { distanceOf } from "./scene/measure";
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

const stateOf = (t_s, agent, more = {}) => ({
  t_s, run: "1", scale_known: true, server: { points: 10 * t_s, ms_per_set: 5 }, groups: [], links: [],
  agents: [{ name: "a", alive: true, state: "tracking", why: "", map: 1, tracks: 200, bound: 150, frame_ms: 9, lag_s: 0.05, kB_up_per_s: 20, ...agent }], ...more,
});

test("who had a place and has none is lost until it is back", () => {
  const chronicle = new Chronicle();
  const states = [{ state: "none" }, {}, { state: "lost", why: "dark" }, { state: "none", map: 0 }, {}, { alive: false }, { state: "none" }];
  states.forEach((agent, i) => chronicle.addState(stateOf(i, agent)));
  assert.deepEqual(chronicle.spans.get("a").map(({ state }) => state), ["none", "tracking", "lost", "tracking", "gone", "none"]);
  chronicle.addState(stateOf(7, { alive: false }, { finishing: true }));
  assert.equal(chronicle.spanAt("a", 7).state, "ended");
});

test("figures over time stay in bounded memory, and what is not known is left out", () => {
  const figures = new Figures();
  for (let i = 0; i < 30000; ++i) figures.add(stateOf(i / 4, { lag_s: null }));
  assert.equal(figures.ofMap("points", 7000, 7060).values.length, 240);
  assert.ok(figures.ofMap("points", -1, 1e9).values.length <= 8000);
  assert.deepEqual(figures.ofAgent("a", "lag", 0, 1e9).values, []);
});

test("why a camera is lost, in its own terms", () => {
  const cause = (agent) => causeOf(stateOf(0, agent).agents[0]);
  assert.match(cause({ images: "featureless" }), /Dark, dazzled or covered/);
  assert.match(cause({ images: "missing" }), /No images/);
  assert.match(cause({ tracks: 12 }), /dark, blurred or blank/);
  assert.match(cause({ tracks: 200, bound: 3 }), /Unknown place/);
  assert.equal(cause({}), "");
});

test("what is said of the run as a whole", () => {
  const said = (link, state) => noticeOf({ link, heard_ms: 1000 }, state, 12000);
  assert.equal(said({ kind: "open" }, stateOf(1)), undefined);
  assert.match(said({ kind: "open" }, stateOf(1, {}, { agents: [], join: "--domain 7" })).command, /^coslam-agent --domain 7 --id/);
  assert.match(said({ kind: "lost", again_ms: 14000 }, stateOf(1)).text, /11 seconds old.*in 2 s/);
  assert.equal(said({ kind: "over" }, stateOf(1, {}, { result: "/tmp/my run" })).command, "coslam view '/tmp/my run'");
  assert.match(said({ kind: "refused" }).text, /token=/);
});

test("the map as PLY", () => {
  const octets = Buffer.from(plyOf([{ id: 7, position: [1, 2, 3], sigma: 0.5 }], "units"));
  const text = octets.toString("latin1");
  assert.match(text, /scale is not known\nelement vertex 1\n/);
  const data = octets.subarray(text.indexOf("end_header\n") + 11);
  assert.deepEqual([0, 4, 8, 12].map((at) => data.readFloatLE(at)), [1, 2, 3, 0.5]);
  assert.equal(data.readUInt32LE(16), 7);
});

test("a length has the deviation along it", () => {
  const { length, sigma } = distanceOf({ position: [0, 0, 0], covariance: [4, 0, 0, 1, 0, 1] }, { position: [3, 0, 0], covariance: [5, 0, 0, 1, 0, 1] });
  assert.deepEqual([length, sigma], [3, 3]);
});

test("a map of its own unit is drawn to fit beside, and stays so", () => {
  const frames = new Frames();
  const sized = (name, size) => frames.of(name).extent.setFromArray([0, 0, 0, size, 1, size]);
  sized("map", 10);
  sized("map_2", 400);
  frames.arrange();
  const { scale } = frames.of("map_2");
  assert.ok(400 * scale < 6 && 400 * scale > 3);
  sized("map_2", 440);
  frames.arrange();
  assert.equal(frames.of("map_2").scale, scale);
  frames.takeState({ scale_known: true, agents: [{ map: 1, frame: "map", scale_known: true }, { map: 2, frame: "map_2", scale_known: true }] });
  frames.arrange();
  assert.equal(frames.of("map_2").scale, 1);
});

// Colours as numbers, linear; how they look to eyes without one of the kinds of cones (Machado, Oliveira and Fernandes 2009).
const linear = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
const EYES = [
  [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
];
function oklab(rgb) {
  const mix = (rows, v) => rows.map((row) => row.reduce((sum, k, i) => sum + k * v[i], 0));
  const cones = mix([[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566], [0.0883024619, 0.2817188376, 0.6299787005]], rgb).map(Math.cbrt);
  return mix([[0.2104542553, 0.793617785, -0.0040720468], [1.9779984951, -2.428592205, 0.4505937099], [0.0259040371, 0.7827717662, -0.808675766]], cones);
}
const seen = (eye, rgb) => eye.map((row) => Math.min(1, Math.max(0, row.reduce((sum, k, i) => sum + k * rgb[i], 0))));
const apart = (a, b) => Math.min(...EYES.map((eye) => Math.hypot(...oklab(seen(eye, a)).map((v, i) => v - oklab(seen(eye, b))[i]))));

test("texts can be read, and cameras told apart by colour-blind eyes, in both themes", async () => {
  const css = await readFile("src/style/theme.css", "utf8");
  const themes = css.split(':root[data-theme="light"]').map((part) => Object.fromEntries([...part.matchAll(/--([\w-]+): (#[0-9a-f]{6});/g)].map(([, name, hex]) => [name, linear(hex)])));
  for (const theme of themes) {
    const contrast = (a, b) => { const [x, y] = [theme[a], theme[b]].map(luminance).sort((p, q) => q - p); return (x + 0.05) / (y + 0.05); };
    const cameras = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => `camera-${i}`);
    const readable = [...["text", "dim", "faint", "accent", "lost", "relative", "moving"].flatMap((name) => [[name, "panel"], [name, "background"], [name, "raised"]]),
      ...cameras.map((name) => [name, "background"]), ["on-lost", "lost"], ["on-accent", "accent"]];
    for (const [a, b] of readable) assert.ok(contrast(a, b) >= 4.5, `${a} on ${b}: ${contrast(a, b).toFixed(2)}`);
    for (const [i, a] of cameras.slice(0, 4).entries()) {
      for (const b of cameras.slice(0, i)) assert.ok(apart(theme[a], theme[b]) > 0.055, `${a} and ${b}: ${apart(theme[a], theme[b]).toFixed(3)}`);
    }
  }
});

test("a path's quality is told with what it rests on, once", () => {
  const open = { quality: "fair", why: "what it saw leaves its path open by 0.5 % of its length", length: 5.8, sigma: 0.0293, sigma_percent: 0.505 };
  assert.equal(pathSentence(open, true), "Its path is fair: an error of about 0.029 m over 5.8 m, 0.51 %, is to be expected.");
  const images = { ...open, why: "34 % of its images have no pose in the common map" };
  assert.equal(pathSentence(images, false), "Its path is fair: an error of about 0.029 over 5.8, 0.51 %, is to be expected; 34 % of its images have no pose in the common map.");
  const untold = { quality: "poor", why: "its images do not tell its path", length: 0.1, sigma: null, sigma_percent: null };
  assert.equal(pathSentence(untold, true), "Its path is poor; its images do not tell its path.");
});

test("a map is as good as its worst path", () => {
  const of = (...qualities) => ({ agents: qualities.map((quality) => ({ path: quality && { quality } })) });
  assert.equal(worstPath(of("good", "fair", null)), "fair");
  assert.equal(worstPath(of("poor", "good")), "poor");
  assert.equal(worstPath(of(null)), null);
});
