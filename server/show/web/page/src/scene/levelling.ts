// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The maps as they lie: which way is up by the ways of their cameras, and how much room they take.
import { secondsOf, type Path, type Pose } from "../data/types";
import type { CameraMark } from "./cameras";
import type { Frames } from "./frames";
import type { Points } from "./points";

export function levelMaps(frames: Frames, paths: readonly Path[], again: boolean): void {
  const poses = new Map<string, { all: Pose[]; from_s: number; to_s: number }>();
  for (const path of paths) {
    if (path.poses.length === 0) continue;
    const [first_s, last_s] = [path.poses[0]!, path.poses.at(-1)!].map(({ header }) => secondsOf(header)) as [number, number];
    const own = poses.get(path.header.frame_id) ?? { all: [], from_s: Infinity, to_s: -Infinity };
    own.all.push(...path.poses.map(({ pose }) => pose));
    poses.set(path.header.frame_id, { all: own.all, from_s: Math.min(own.from_s, first_s), to_s: Math.max(own.to_s, last_s) });
  }
  for (const [name, { all, from_s, to_s }] of poses) {
    frames.level(name, all, again);
    frames.settle(name, to_s - from_s);
  }
}

export function measureMaps(frames: Frames, points: Points, cameras: Iterable<CameraMark>): void {
  for (const frame of frames.all.values()) frame.extent.makeEmpty();
  points.measureFrames(frames);
  for (const mark of cameras) {
    const frame = frames.all.get(mark.frame);
    if (!frame) continue;
    for (const place of mark.places()) frame.extent.expandByPoint(place.applyQuaternion(frame.turned));
  }
}
