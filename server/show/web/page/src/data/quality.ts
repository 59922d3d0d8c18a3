// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// How good paths are, in words.
import type { PathQuality, RunState } from "./types";

// What is to be expected of a path without truth.
export function pathSentence(path: PathQuality, metres: boolean): string {
  const unit = metres ? " m" : "";
  const error = path.sigma === null || path.sigma_percent === null ? "" :
    `: an error of about ${precise(path.sigma)}${unit} over ${precise(path.length)}${unit}, ${precise(path.sigma_percent)} %, is to be expected`;
  const why = path.why === "" || (error !== "" && path.why.startsWith("what it saw")) ? "" : `; ${path.why}`;
  return `Its path is ${path.quality}${error}${why}.`;
}
const precise = (value: number): string => String(Number(value.toPrecision(2)));

// The map is as good as its worst path; null: nothing is known of any yet.
export const worstPath = (state: RunState): string | null =>
  ["poor", "fair", "good"].find((quality) => state.agents.some((agent) => agent.path?.quality === quality)) ?? null;
