// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Why a camera is lost, in the words of somebody who holds it, as far as the state tells.
import type { AgentState } from "./types";

const FEW_TRACKS = 40;
const FEW_BOUND = 15;

const OF_IMAGES: Record<string, string> = {
  missing: "No images come",
  unreadable: "Its images cannot be read",
  resized: "Its images have another size",
  concealed: "Its images are damaged",
  cut_off: "Its images are cut off",
  repeated: "Its images stand still",
  out_of_order: "Its images come out of order",
  featureless: "Dark, dazzled or covered",
  alternating: "Its images are of another setting",
};

// Empty: nothing is known beside what the server says.
export function causeOf({ images = "none", tracks, bound }: AgentState): string {
  if (images !== "none") return OF_IMAGES[images] ?? "Its images are no good";
  if (tracks < FEW_TRACKS) return tracks === 0 ? "Nothing to follow: dark, blurred or blank" : "Too little to follow: dark, blurred or blank";
  return bound < FEW_BOUND ? "Unknown place: look back at something seen before" : "";
}
