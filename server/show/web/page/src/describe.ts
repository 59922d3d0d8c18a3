// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is said of the thing that is picked.
import { causeOf } from "./data/cause";
import { isKnown, positionCovariance } from "./scene/covariance";
import type { Picked } from "./scene/pick";
import { DRAWN_SIGMAS, eigen } from "./scene/selection";
import type { View } from "./scene/view";
import { digits, length, seconds } from "./ui/dom";
import type { Shown } from "./ui/inspector";

const axes = (covariance: readonly number[], unit: string): string => {
  const [xx, xy, xz, yy, yz, zz] = covariance as [number, number, number, number, number, number];
  const values = eigen([xx, xy, xz, xy, yy, yz, xz, yz, zz]).values.sort((a, b) => b - a);
  return values.map((value) => length(Math.sqrt(Math.max(0, value)), unit)).join(" × ");
};

// Coordinates in a frame, in its unit.
function place(view: View, frame: string, p: readonly number[]): [string, string][] {
  const text = p.map((value, i) => `${"xyz"[i]} ${digits(value, 2).replace("-", "−")}`).join("  ");
  return [["Position", `${text} ${view.unitOf(frame)}`], ["In frame", frame]];
}

// The covariance of the picked thing: what the server told, else a ball of the known size.
export function describe(view: View, picked: Picked, told: number[] | undefined): Shown | undefined {
  if (picked.kind === "point") return describePoint(view, picked.id, told);
  if (picked.kind === "moving") return describeMoving(view, picked.id);
  if (picked.kind === "camera") return describeCamera(view, picked.name);
  if (picked.kind === "object") return describeObject(view, picked.id);
  const id = `${picked.agent}/${picked.id}`;
  return { title: `Track ${id}`, about: "What a camera follows from frame to frame.", figures: [], ask: { kind: "track", id } };
}

function describePoint(view: View, id: number, told: number[] | undefined): Shown {
  const index = view.points.indexOf(id);
  const ask = { kind: "point" as const, id: String(id) };
  if (index < 0) return { title: `Point ${id}`, about: "Not on the map at this instant.", figures: [], ask };
  const point = view.points.figures(index);
  const frame = view.points.frameOf(index, view.frames);
  const unit = view.unitOf(frame);
  const figures: [string, string][] = [["Deviation", length(point.sigma, unit)]];
  if (told) figures.push(["Axes, 1 σ", axes(told, unit)]);
  figures.push(["Views", String(point.views)], ...place(view, frame, point.position), ["Map", String(point.map)]);
  const about = point.onTrial ? "On trial: poses do not rest on it yet." : "Static.";
  return { title: `Point ${id}`, about: `${about} Drawn at ${DRAWN_SIGMAS} σ.`, figures, ask };
}

function describeMoving(view: View, id: number): Shown {
  const { now } = view.moving;
  const at = now ? now.id.indexOf(id) : -1;
  const figures: [string, string][] = [];
  if (now && at >= 0) {
    figures.push(["Deviation", length(now.sigma[at]!, view.unit)]);
    figures.push(...place(view, view.moving.frame, [...now.xyz.subarray(3 * at, 3 * at + 3)]));
    if (now.object[at] !== 0) figures.push(["Object", String(now.object[at])]);
  }
  return { title: `Moving point ${id}`, about: at < 0 ? "Not seen at this instant." : "Seen to move.", figures, ask: { kind: "point", id: String(id) } };
}

function describeCamera(view: View, name: string): Shown {
  const mark = view.cameras.get(name);
  const figures: [string, string][] = [];
  if (mark?.pose) {
    const { x, y, z } = mark.pose.position;
    figures.push(...place(view, mark.frame, [x, y, z]));
    if (isKnown(mark.covariance)) figures.push(["Axes, 1 σ", axes(positionCovariance(mark.covariance), view.unitOf(mark.frame))]);
  }
  for (const [a, b, shared] of view.state?.links ?? []) {
    if (a === name || b === name) figures.push([`Shared with ${a === name ? b : a}`, `${shared} points`]);
  }
  const state = mark?.state;
  if (state && state.lag_s !== null) figures.push(["Behind by", seconds(state.lag_s)]);
  const cause = state && mark?.standing === "lost" ? causeOf(state) : "";
  const about = state?.why ? `${cause === "" ? "" : `${cause}. `}The server says: ${state.why}.` : state?.map ? `In map ${state.map}.` : "In no map.";
  return { title: name, about, figures, ask: { kind: "camera", id: name } };
}

function describeObject(view: View, id: number): Shown {
  const mark = view.objects.all.get(id);
  if (!mark) return { title: `Object ${id}`, about: "Not seen at this instant.", figures: [], ask: undefined };
  const speed = mark.speed();
  const size = mark.size.toArray().map((side) => length(side, view.unit)).join(" × ");
  const figures: [string, string][] = [["Size", size]];
  if (speed !== undefined) figures.push(["Speed", `${digits(speed, 2)} ${view.unit}/s`]);
  return { title: `Object ${id}`, about: "Points that move as one.", figures, ask: undefined };
}
