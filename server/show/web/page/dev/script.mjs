// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What happens in the made-up run, and when.
export const JOINED_S = 14;  // cam2's map meets the other one
const LOST = { from_s: 20, to_s: 26, agent: "cam1" };
const SPLIT = { from_s: 33, to_s: 41 };
export const NAMES = ["cam0", "cam1", "cam2"];

export const mapOf = (index, t_s) => (index === 2 && t_s < JOINED_S ? 2 : 1);
export const frameOf = (map) => (map === 1 ? "map" : `map_${map}`);
export const isLost = (name, t_s) => name === LOST.agent && t_s >= LOST.from_s && t_s < LOST.to_s;

export function groupsAt(t_s) {
  if (t_s < JOINED_S) return [["cam0", "cam1"], ["cam2"]];
  if (t_s >= SPLIT.from_s && t_s < SPLIT.to_s) return [["cam0"], ["cam1", "cam2"]];
  return [NAMES];
}

const happens = (t_s, kind, text, agents) => ({ t_s, kind, text, agents });
export const EVENTS = [
  happens(0.2, "joined", "cam0 joined", ["cam0"]),
  happens(0.3, "joined", "cam1 joined", ["cam1"]),
  happens(0.6, "map_started", "cam0 and cam1 started map 1", ["cam0", "cam1"]),
  happens(1.1, "joined", "cam2 joined", ["cam2"]),
  happens(2.4, "map_started", "cam2 started map 2 alone", ["cam2"]),
  happens(JOINED_S, "maps_joined", "map 2 became part of map 1: cam2 knew a place of cam0 again", ["cam2", "cam0"]),
  happens(JOINED_S + 0.3, "merge", "cam0, cam1 and cam2 see common points", NAMES),
  happens(LOST.from_s, "lost", "cam1 lost its pose: 5 of its points are seen, 12 are needed", ["cam1"]),
  happens(LOST.to_s, "found", "cam1 has a pose again", ["cam1"]),
  happens(SPLIT.from_s, "split", "cam0 sees nothing in common with cam1 and cam2", ["cam0"]),
  happens(SPLIT.to_s, "merge", "cam0, cam1 and cam2 see common points", NAMES),
  happens(47, "loop", "the path of cam0 closed: 14 key frames moved, at most 0.08 m", ["cam0"]),
];
export const WHY_LOST = "5 of its points are seen, 12 are needed";
