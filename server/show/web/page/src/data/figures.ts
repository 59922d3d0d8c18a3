// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Figures over time, for plots, in bounded memory: the older part of a long row is thinned.
import { countUntil } from "./source";
import type { RunState } from "./types";

export const AGENT_FIGURES = ["tracks", "ms", "lag", "kB"] as const;
export type AgentFigure = (typeof AGENT_FIGURES)[number];
export type MapFigure = "points" | "ms a set";

export interface Curve { t_s: number[]; values: number[] }

const MOST = 8000;        // entries of a row
const NEW_PART = 0.4;     // which is not thinned

export class Figures {
  private readonly rows = new Map<string, Curve>();

  clear(): void { this.rows.clear(); }

  add({ t_s, server, agents }: RunState): void {
    this.put("points", t_s, server.points);
    this.put("ms a set", t_s, server.ms_per_set);
    for (const agent of agents) {
      if (!agent.alive) continue;
      const of = (name: AgentFigure, value: number | null) => this.put(`${agent.name}/${name}`, t_s, value);
      of("tracks", agent.tracks);
      of("ms", agent.frame_ms);
      of("lag", agent.lag_s);
      of("kB", agent.kB_up_per_s);
    }
  }

  ofMap(name: MapFigure, from_s: number, to_s: number): Curve { return this.cut(name, from_s, to_s); }
  ofAgent(agent: string, name: AgentFigure, from_s: number, to_s: number): Curve { return this.cut(`${agent}/${name}`, from_s, to_s); }

  private put(key: string, t_s: number, value: number | null): void {
    if (value === null || !Number.isFinite(value)) return;
    let row = this.rows.get(key);
    if (!row) this.rows.set(key, (row = { t_s: [], values: [] }));
    if (row.t_s.length > 0 && row.t_s.at(-1)! >= t_s) return;
    row.t_s.push(t_s);
    row.values.push(value);
    if (row.t_s.length > MOST) this.rows.set(key, thinned(row));
  }

  private cut(key: string, from_s: number, to_s: number): Curve {
    const row = this.rows.get(key);
    if (!row) return { t_s: [], values: [] };
    const [from, to] = [from_s, to_s].map((limit_s) => countUntil(row.t_s.length, (i) => row.t_s[i]!, limit_s));
    return { t_s: row.t_s.slice(from, to), values: row.values.slice(from, to) };
  }
}

function thinned({ t_s, values }: Curve): Curve {
  const old = Math.ceil(t_s.length * (1 - NEW_PART));
  const kept = (_: number, i: number) => i >= old || i % 2 === 0;
  return { t_s: t_s.filter(kept), values: values.filter(kept) };
}
