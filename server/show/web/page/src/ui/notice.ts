// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What has to be said of the run as a whole: nobody is here yet, it is over, the server is silent or wants a token.
import type { Live } from "../data/live";
import type { RunState } from "../data/types";
import { make, plural, setText } from "./dom";

export interface Said {
  kind: "lost" | "over" | "wait";
  title: string;
  text: string;
  command?: string;
  retry?: boolean;
}

const shellWord = (text: string): string => (/^[\w./:+@%-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

// undefined: all is as it should be.
export function noticeOf(live: Live, state: RunState | undefined, now_ms: number): Said | undefined {
  const { link } = live;
  if (link.kind === "refused") {
    return { kind: "wait", title: "This server wants a token", text: "Add ?token=… to the address. The server printed the whole address when it was started." };
  }
  if (link.kind === "over") {
    if (!state) return { kind: "over", title: "The run is over", text: "It ended before anything was heard of it." };
    const result = state.result ?? "";
    if (result === "") return { kind: "over", title: "The run is over", text: "It kept no result. What you see is how it ended." };
    return { kind: "over", title: "The run is over", text: "What you see is how it ended. To see it again at any time:", command: `coslam view ${shellWord(result)}` };
  }
  if (link.kind === "lost" || (link.kind === "connecting" && live.tries > 0)) {
    const next = link.kind === "lost" ? `Next try in ${Math.max(0, Math.ceil((link.again_ms - now_ms) / 1000))} s.` : "Trying again.";
    const old = live.heard_ms === 0 ? "" : `What you see is ${plural(Math.round((now_ms - live.heard_ms) / 1000), "second")} old. `;
    return { kind: "lost", title: "The server does not answer", text: old + next, retry: true };
  }
  if (!state || state.finishing) return undefined;
  if (state.agents.length === 0) return waiting(state);
  if (state.server.points > 0 || state.agents.some(({ map }) => map !== 0)) return undefined;
  return { kind: "wait", title: "No map yet", text: "Move the cameras sideways, not only around, past something with texture: depth shows by that." };
}

function waiting({ join = "" }: RunState): Said {
  const command = join === "" ? {} : { command: `coslam-agent ${join} --id left --source v4l2:0 --calibration left.yaml` };
  return { kind: "wait", title: "Waiting for agents", text: join === "" ? "Nobody has joined yet." : "Nobody has joined yet. On each camera's machine:", ...command };
}

export class Notice {
  readonly element = make("section", { class: "notice", "aria-label": "the run", hidden: "" });
  private readonly title = make("h2", { role: "status" });
  private readonly text = make("p");
  private readonly command = make("code");
  private readonly retry: HTMLButtonElement;

  constructor(onRetry: () => void) {
    this.retry = make("button", { type: "button", onclick: onRetry }, "Try now");
    this.element.append(this.title, this.text, this.command, this.retry);
  }

  show(said: Said | undefined): void {
    this.element.hidden = said === undefined;
    if (!said) return;
    this.element.className = `notice ${said.kind}`;
    setText(this.title, said.title);
    setText(this.text, said.text);
    setText(this.command, said.command ?? "");
    this.command.hidden = said.command === undefined;
    this.retry.hidden = said.retry !== true;
  }
}
