// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Which instant is shown: the newest one, one that was chosen, or one that runs on.
import type { Source } from "./data/source";

export type Mode = "live" | "playing" | "paused";

export class Player {
  mode: Mode = "live";
  private at_s = 0;

  constructor(private source: Source) { this.take(source); }

  // A recording is shown from its end: the whole map.
  take(source: Source): void {
    this.source = source;
    this.mode = source.live ? "live" : "paused";
    this.at_s = source.range.end_s;
  }

  // Infinity: the newest there is.
  get t_s(): number { return this.mode === "live" ? Infinity : this.at_s; }
  get shown_s(): number { return this.mode === "live" ? this.source.range.end_s : this.at_s; }

  advance(passed_s: number): void {
    if (this.mode !== "playing") return;
    const { end_s } = this.source.range;
    this.at_s += passed_s;
    if (this.at_s < end_s) return;
    this.at_s = end_s;
    this.mode = this.source.live ? "live" : "paused";
  }

  seek(t_s: number): void {
    const { start_s, end_s } = this.source.range;
    if (!Number.isFinite(start_s)) return;
    this.at_s = Math.min(end_s, Math.max(start_s, t_s));
    if (this.mode === "live") this.mode = "paused";
  }

  toggle(): void {
    if (this.mode === "playing") this.mode = "paused";
    else if (this.mode === "live") {
      this.at_s = this.source.range.end_s;
      this.mode = "paused";
    } else {
      if (this.at_s >= this.source.range.end_s - 0.05 && !this.source.live) this.at_s = this.source.range.start_s;
      this.mode = "playing";
    }
  }

  goLive(): void { if (this.source.live) this.mode = "live"; }
}
