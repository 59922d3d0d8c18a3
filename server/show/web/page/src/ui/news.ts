// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What just happened, for a few seconds.
import type { Chronicle } from "../data/chronicle";
import type { RunEvent } from "../data/types";
import { make } from "./dom";

const SHOWN_MS = 7000;
const NEW_S = 5;             // what is older is told on the time line alone
const MOST = 3;
const QUIET = new Set(["joined", "left", "map_started"]);  // on the time line alone

export class News {
  readonly element = make("div", { class: "toasts", role: "log", "aria-live": "polite", "aria-label": "what just happened" });
  private known = new WeakSet<RunEvent>();

  // What happened before is no news.
  forget(chronicle: Chronicle): void {
    this.known = new WeakSet(chronicle.events);
    this.element.replaceChildren();
  }

  show(chronicle: Chronicle, live: boolean, now_s: number): void {
    for (const event of chronicle.events.slice(-MOST)) {
      if (this.known.has(event)) continue;
      this.known.add(event);
      if (live && now_s - event.t_s < NEW_S && !QUIET.has(event.kind)) this.add(event);
    }
  }

  note(text: string, kind = "note"): void { this.put(text, kind); }

  private add(event: RunEvent): void { this.put(event.text, event.kind); }

  private put(text: string, kind: string): void {
    const item = make("p", { class: kind }, text);
    this.element.append(item);
    while (this.element.childElementCount > MOST) this.element.firstElementChild!.remove();
    setTimeout(() => item.remove(), SHOWN_MS);
  }
}
