// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the time line shows of a run: who had which state when, and what happened.
import { Figures } from "./figures";
import type { AgentState, AgentStatus, RunEvent, RunState } from "./types";

export type Standing = AgentStatus | "gone" | "ended";  // ended: with the whole run
export interface Span { from_s: number; to_s: number; state: Standing; why: string }

const MOST_SPANS = 4000;
const MOST_EVENTS = 5000;
const GAP_S = 3;  // no state for so long: nobody knows what was

export class Chronicle {
  readonly spans = new Map<string, Span[]>();
  readonly events: RunEvent[] = [];
  readonly figures = new Figures();
  version = 0;

  clear(): void {
    this.spans.clear();
    this.events.length = 0;
    this.figures.clear();
    ++this.version;
  }

  // In the order of time.
  addState(state: RunState): void {
    for (const agent of state.agents) {
      let own = this.spans.get(agent.name);
      if (!own) this.spans.set(agent.name, (own = []));
      const last = own.at(-1);
      const now = standingOf(agent, state.finishing === true, last);
      const goesOn = last !== undefined && state.t_s - last.to_s < GAP_S;
      if (goesOn) last.to_s = Math.max(last.to_s, state.t_s);
      if (goesOn && last.state === now) continue;
      own.push({ from_s: state.t_s, to_s: state.t_s, state: now, why: agent.why });
      if (own.length > MOST_SPANS) own.splice(0, own.length - MOST_SPANS);
    }
    this.figures.add(state);
    ++this.version;
  }

  // A server tells what happened before to each who connects, again too.
  addEvent(event: RunEvent): void {
    let at = this.events.length;
    while (at > 0 && this.events[at - 1]!.t_s > event.t_s) --at;
    for (let same = at - 1; same >= 0 && this.events[same]!.t_s === event.t_s; --same) {
      if (this.events[same]!.text === event.text) return;
    }
    this.events.splice(at, 0, event);
    if (this.events.length > MOST_EVENTS) this.events.shift();
    ++this.version;
  }

  // How an agent stands in a state, where what came before counts.
  standing(agent: AgentState, { t_s, finishing }: RunState): Standing {
    const span = this.spanAt(agent.name, t_s);
    return span && t_s - span.to_s < GAP_S ? span.state : standingOf(agent, finishing === true);
  }

  // The span of an agent at that time.
  spanAt(agent: string, t_s: number): Span | undefined {
    return this.spans.get(agent)?.findLast((span) => span.from_s <= t_s + 1e-6);
  }
}

// One that had a place and has none is lost until it is back.
function standingOf(agent: AgentState, finishing: boolean, last?: Span): Standing {
  if (!agent.alive || finishing) return finishing ? "ended" : "gone";
  const hadPlace = last !== undefined && !["gone", "ended", "none"].includes(last.state);
  return agent.state === "none" && hadPlace ? "lost" : agent.state;
}
