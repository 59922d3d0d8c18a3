// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Where messages come from: a server that is heard live, or a recording.
import type { Chronicle } from "./chronicle";
import type { Message } from "./types";

export interface Source {
  readonly live: boolean;
  readonly chronicle: Chronicle;
  readonly range: { start_s: number; end_s: number };
  topics(): Iterable<string>;
  // Loads what last() and between() are asked for at that time.
  prepare(t_s: number): Promise<void>;
  // The newest message of a topic that is not after t_s.
  last(topic: string, t_s: number): Message | undefined;
  between(topic: string, from_s: number, to_s: number): Message[];
  // The tracks of an agent are sent, or read, only while somebody looks at them.
  want(agent: string, tracks: boolean): void;
  close(): void;
}

// How many entries of rising times are not after t_s.
export function countUntil(size: number, time_s: (index: number) => number, t_s: number): number {
  let low = 0;
  let high = size;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (time_s(middle) <= t_s) low = middle + 1;
    else high = middle;
  }
  return low;
}
