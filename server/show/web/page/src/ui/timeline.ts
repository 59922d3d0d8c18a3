// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The time line: who had which state when, what happened, and which instant is shown. Dragged, or zoomed by the wheel.
import type { Chronicle, Standing } from "../data/chronicle";
import type { Source } from "../data/source";
import type { RunEvent } from "../data/types";
import type { Player } from "../player";
import { button, clock, make, setText } from "./dom";

const GUTTER_PX = 62;
const EVENTS_PX = 18;
const LANE_PX = 13;
const AXIS_PX = 16;
const EDGE_PX = 12;
const LEAST_SPAN_S = 2;
const NEAR_PX = 7;
const UTC_S = 1e8;
const STEPS_S = [0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600, 7200];

// Names of colours, by kind of event and by state.
const EVENT_COLOURS: Record<string, string> = {
  lost: "lost", split: "relative", found: "good", merge: "accent", maps_joined: "accent", loop: "accent",
};
const SPAN_COLOURS: Partial<Record<Standing, string>> = { relative: "relative", lost: "lost", none: "none", unheard: "none" };  // tracking: the camera's
const SPAN_PX: Partial<Record<Standing, number>> = { tracking: 4, relative: 8, lost: 8, none: 1, unheard: 1 };            // else nothing
const SPAN_WORDS: Partial<Record<Standing, string>> = { none: "waiting", unheard: "no images received", gone: "left", ended: "the run is over" };

export class Timeline {
  readonly element: HTMLElement;
  private readonly canvas = make("canvas", { tabindex: "0", role: "slider", "aria-label": "time", class: "track" });
  private readonly time = make("output", { class: "time" });
  private readonly play: HTMLButtonElement;
  private readonly live: HTMLButtonElement;
  private readonly tip = make("div", { class: "tip", hidden: "" });
  private window: [number, number] | undefined;  // zoomed to, else all
  private agents: string[] = [];
  private drawn = "";
  private chronicle: Chronicle;

  constructor(private source: Source, private readonly player: Player, private readonly colourIndex: (agent: string) => number, private readonly onChange: () => void) {
    this.chronicle = source.chronicle;
    this.play = button("play", "Play or pause (space)", () => { this.player.toggle(); this.onChange(); });
    this.live = make("button", { type: "button", class: "go-live", title: "Back to now (L)", onclick: () => { this.player.goLive(); this.onChange(); } }, "Live");
    const left = make("div", { class: "transport" }, this.play, this.time, this.live);
    this.element = make("footer", { class: "timeline" }, left, this.canvas, this.tip);
    this.listen();
    new ResizeObserver(() => { this.drawn = ""; }).observe(this.canvas);
  }

  take(source: Source): void {
    this.source = source;
    this.chronicle = source.chronicle;
    this.window = undefined;
    this.drawn = "";
  }

  repaint(): void { this.drawn = ""; }

  // live: there is a now to go back to.
  show(agents: string[], live: boolean): void {
    this.agents = agents;
    const { range } = this.source;
    const t_s = this.player.shown_s;
    const known = Number.isFinite(range.start_s);
    setText(this.time, known ? clock(t_s - this.zero_s) : "–:––");
    this.time.title = known && range.start_s > UTC_S ? new Date(1000 * t_s).toISOString() : "time of the run";
    const playing = this.player.mode === "playing";
    this.play.querySelector("path")!.setAttribute("d", this.player.mode === "paused" ? "M8 5v14l11-7z" : "M8 5v14M16 5v14");
    this.play.setAttribute("aria-pressed", String(playing));
    this.live.hidden = !live;
    this.live.setAttribute("aria-pressed", String(this.player.mode === "live"));
    this.canvas.setAttribute("aria-valuenow", known ? (t_s - this.zero_s).toFixed(1) : "0");
    this.canvas.setAttribute("aria-valuetext", known ? clock(t_s - this.zero_s) : "nothing yet");
    if (!known) return;
    // Redrawn when it would look different.
    const [from, to] = this.span();
    const pixel_s = (to - from) / Math.max(1, this.canvas.clientWidth);
    const look = [this.chronicle.version, agents.length, Math.round(t_s / pixel_s), Math.round(from / pixel_s), Math.round(4 * to), this.canvas.clientWidth].join();
    if (look !== this.drawn) this.draw(from, to, t_s);
    this.drawn = look;
  }

  // Files are timed from 0, live cameras in UTC.
  private get zero_s(): number { return this.source.range.start_s > UTC_S ? this.source.range.start_s : 0; }

  private span(): [number, number] {
    const { start_s, end_s } = this.source.range;
    if (!this.window) return [start_s, Math.max(end_s, start_s + LEAST_SPAN_S)];
    if (this.player.mode !== "live") return this.window;
    return [end_s - (this.window[1] - this.window[0]), end_s];
  }

  private xOf(t_s: number): number {
    const [from, to] = this.span();
    return GUTTER_PX + ((t_s - from) / (to - from)) * (this.canvas.clientWidth - GUTTER_PX - EDGE_PX);
  }

  private timeAt(x: number): number {
    const [from, to] = this.span();
    return from + ((x - GUTTER_PX) / Math.max(1, this.canvas.clientWidth - GUTTER_PX - EDGE_PX)) * (to - from);
  }

  private listen(): void {
    const { canvas } = this;
    const seek = (event: PointerEvent) => {
      this.player.seek(this.timeAt(event.offsetX));
      this.onChange();
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      seek(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (canvas.hasPointerCapture(event.pointerId)) seek(event);
      this.showTip(event);
    });
    canvas.addEventListener("pointerleave", () => { this.tip.hidden = true; });
    canvas.addEventListener("dblclick", () => { this.window = undefined; });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(event);
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const step_s = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10 }[event.key];
      if (step_s === undefined) return;
      event.preventDefault();
      this.player.seek(this.player.shown_s + step_s);
      this.onChange();
    });
  }

  private zoom(event: WheelEvent): void {
    const { start_s, end_s } = this.source.range;
    const [from, to] = this.span();
    const at = this.timeAt(event.offsetX);
    const factor = Math.exp(0.0015 * event.deltaY);
    const wide = Math.max(LEAST_SPAN_S, factor * (to - from));
    if (wide >= end_s - start_s) {
      this.window = undefined;
      return;
    }
    const begin = Math.min(Math.max(start_s, at - ((at - from) / (to - from)) * wide), end_s - wide);
    this.window = [begin, begin + wide];
  }

  private eventNear(x: number): RunEvent | undefined {
    let best: RunEvent | undefined;
    let least = NEAR_PX;
    for (const event of this.chronicle.events) {
      const far = Math.abs(this.xOf(event.t_s) - x);
      if (far <= least) [best, least] = [event, far];
    }
    return best;
  }

  private showTip({ offsetX, offsetY }: PointerEvent): void {
    const t_s = this.timeAt(offsetX);
    const event = offsetY < EVENTS_PX + 4 ? this.eventNear(offsetX) : undefined;
    const lane = this.agents[Math.floor((offsetY - EVENTS_PX) / LANE_PX)];
    const span = lane === undefined ? undefined : this.chronicle.spanAt(lane, t_s);
    const words = event ? event.text : span ? `${lane}: ${SPAN_WORDS[span.state] ?? span.state}${span.why === "" ? "" : `, ${span.why}`}` : "";
    setText(this.tip, `${clock((event?.t_s ?? t_s) - this.zero_s)}${words === "" ? "" : `  ${words}`}`);
    this.tip.hidden = offsetX < GUTTER_PX;
    const x = this.canvas.offsetLeft + offsetX;
    const room = this.element.clientWidth - this.tip.offsetWidth - 8;
    this.tip.style.left = `${Math.max(8, Math.min(x - this.tip.offsetWidth / 2, room))}px`;
  }

  private draw(from: number, to: number, t_s: number): void {
    const { canvas } = this;
    const ratio = Math.min(2, window.devicePixelRatio);
    const width = canvas.clientWidth;
    const height = EVENTS_PX + LANE_PX * Math.max(1, this.agents.length) + AXIS_PX;
    canvas.style.height = `${height}px`;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const context = canvas.getContext("2d")!;
    context.scale(ratio, ratio);
    const style = getComputedStyle(canvas);
    const colour = (name: string) => style.getPropertyValue(`--${name}`);
    context.font = `10.5px ${style.fontFamily}`;
    this.drawAxis(context, colour, from, to, height);
    this.drawLanes(context, colour);
    this.drawEvents(context, colour, from, to);
    const x = Math.round(this.xOf(t_s));
    context.fillStyle = colour("accent");
    context.fillRect(x - 1, 2, 2, height - AXIS_PX);
    context.beginPath();
    context.arc(x, 5, 5, 0, 2 * Math.PI);
    context.fill();
  }

  private drawAxis(context: CanvasRenderingContext2D, colour: (name: string) => string, from: number, to: number, height: number): void {
    const width = context.canvas.clientWidth - GUTTER_PX - EDGE_PX;
    const step = STEPS_S.find((each) => ((each * width) / (to - from)) > 84) ?? 14400;
    context.textAlign = "center";
    for (let tick = Math.ceil((from - this.zero_s) / step) * step; tick <= to - this.zero_s; tick += step) {
      const x = Math.round(this.xOf(tick + this.zero_s));
      context.fillStyle = colour("line");
      context.fillRect(x, EVENTS_PX, 1, height - EVENTS_PX - AXIS_PX + 3);
      context.fillStyle = colour("dim");
      context.fillText(clock(tick).replace(/\.0$/, ""), x, height - 3);
    }
  }

  private drawLanes(context: CanvasRenderingContext2D, colour: (name: string) => string): void {
    context.textAlign = "left";
    const width = context.canvas.clientWidth - EDGE_PX;
    for (const [index, agent] of this.agents.entries()) {
      const y = EVENTS_PX + index * LANE_PX;
      context.fillStyle = colour("dim");
      const name = agent.length > 9 ? `${agent.slice(0, 8)}…` : agent;
      context.fillText(name, 0, y + LANE_PX - 3);
      for (const span of this.chronicle.spans.get(agent) ?? []) {
        const left = Math.max(GUTTER_PX, this.xOf(span.from_s));
        const right = Math.min(width, this.xOf(span.to_s));
        if (right < left) continue;
        const thick = SPAN_PX[span.state] ?? 0;
        context.fillStyle = colour(SPAN_COLOURS[span.state] ?? `camera-${this.colourIndex(agent)}`);
        context.fillRect(left, y + (LANE_PX - thick) / 2, Math.max(1, right - left), thick);
      }
    }
  }

  private drawEvents(context: CanvasRenderingContext2D, colour: (name: string) => string, from: number, to: number): void {
    for (const event of this.chronicle.events) {
      if (event.t_s < from || event.t_s > to) continue;
      const x = this.xOf(event.t_s);
      context.fillStyle = colour(EVENT_COLOURS[event.kind] ?? "faint");
      context.beginPath();
      context.moveTo(x, EVENTS_PX - 1);
      context.lineTo(x - 4, EVENTS_PX - 8);
      context.lineTo(x + 4, EVENTS_PX - 8);
      context.fill();
    }
  }
}
