// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is said of the thing that is picked.
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

const place = (p: readonly number[]): string => p.map((value) => digits(value, 2)).join("  ");

const UNKNOWN_VARIANCE = 1e5;  // servers send 1e6 for what they do not know

export function isKnown(covariance: ArrayLike<number> | undefined): covariance is ArrayLike<number> {
  return covariance !== undefined && covariance[0]! > 0 && covariance[0]! < UNKNOWN_VARIANCE;
}

// The position part of a ROS covariance, xx xy xz yy yz zz.
export function positionCovariance(of: ArrayLike<number>): number[] {
  return [0, 1, 2, 7, 8, 14].map((i) => of[i]!);
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
  const { unit } = view;
  const figures: [string, string][] = [["Deviation", length(point.sigma, unit)]];
  if (told) figures.push(["Axes, 1 σ", axes(told, unit)]);
  figures.push(["Views", String(point.views)], ["Position", place(point.position)], ["Map", String(point.map)]);
  const about = point.onTrial ? "On trial: poses do not rest on it yet." : "Static.";
  return { title: `Point ${id}`, about: `${about} Drawn at ${DRAWN_SIGMAS} σ.`, figures, ask };
}

function describeMoving(view: View, id: number): Shown {
  const { now } = view.moving;
  const at = now ? now.id.indexOf(id) : -1;
  const figures: [string, string][] = [];
  if (now && at >= 0) {
    figures.push(["Deviation", length(now.sigma[at]!, view.unit)]);
    figures.push(["Position", place([...now.xyz.subarray(3 * at, 3 * at + 3)])]);
    if (now.object[at] !== 0) figures.push(["Object", String(now.object[at])]);
  }
  return { title: `Moving point ${id}`, about: at < 0 ? "Not seen at this instant." : "Seen to move.", figures, ask: { kind: "point", id: String(id) } };
}

function describeCamera(view: View, name: string): Shown {
  const mark = view.cameras.get(name);
  const { unit } = view;
  const figures: [string, string][] = [];
  if (mark?.pose) figures.push(["Position", place([mark.pose.position.x, mark.pose.position.y, mark.pose.position.z])]);
  if (isKnown(mark?.covariance)) figures.push(["Axes, 1 σ", axes(positionCovariance(mark!.covariance!), unit)]);
  for (const [a, b, shared] of view.state?.links ?? []) {
    if (a === name || b === name) figures.push([`Shared with ${a === name ? b : a}`, `${shared} points`]);
  }
  const state = mark?.state;
  if (state) figures.push(["Behind by", seconds(state.lag_s)]);
  const about = state?.why ? `${state.state}: ${state.why}` : `In map ${state?.map || "none"}, ${state?.state ?? "unknown"}.`;
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
