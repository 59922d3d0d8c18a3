// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What the time line shows of a run: who had which state when, and what happened.
import type { AgentStatus, RunEvent, RunState } from "./types";

export interface Span { from_s: number; to_s: number; state: AgentStatus | "gone"; why: string }

const MOST_SPANS = 4000;
const MOST_EVENTS = 5000;
const GAP_S = 3;  // no state for so long: nobody knows what was

export class Chronicle {
  readonly spans = new Map<string, Span[]>();
  readonly events: RunEvent[] = [];
  version = 0;

  clear(): void {
    this.spans.clear();
    this.events.length = 0;
    ++this.version;
  }

  // In the order of time.
  addState(state: RunState): void {
    for (const agent of state.agents) {
      let own = this.spans.get(agent.name);
      if (!own) this.spans.set(agent.name, (own = []));
      const now = agent.alive ? agent.state : "gone";
      const last = own.at(-1);
      const goesOn = last !== undefined && state.t_s - last.to_s < GAP_S;
      if (goesOn) last.to_s = Math.max(last.to_s, state.t_s);
      if (goesOn && last.state === now) continue;
      own.push({ from_s: state.t_s, to_s: state.t_s, state: now, why: agent.why });
      if (own.length > MOST_SPANS) own.splice(0, own.length - MOST_SPANS);
    }
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

  // The span of an agent at that time.
  spanAt(agent: string, t_s: number): Span | undefined {
    return this.spans.get(agent)?.findLast((span) => span.from_s <= t_s + 1e-6);
  }
}
