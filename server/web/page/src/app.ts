// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Holds the page together: source, player, view and what stands around it.
import { Vector3 } from "three";

import { Live } from "./data/live";
import { openRecording } from "./data/recording";
import type { Source } from "./data/source";
import { topicName } from "./data/types";
import { describe, isKnown, positionCovariance } from "./describe";
import { Player } from "./player";
import { type Picked, pick } from "./scene/pick";
import { View } from "./scene/view";
import { Agents } from "./ui/agents";
import { make, setText } from "./ui/dom";
import { acceptFiles } from "./ui/files";
import { Header } from "./ui/header";
import { Inspector } from "./ui/inspector";
import { Layers } from "./ui/layers";
import { News } from "./ui/news";
import { flipTheme, startTheme } from "./ui/theme";
import { Timeline } from "./ui/timeline";

const PANELS_MS = 100;    // how often figures are written
const CLICK_PX = 6;
const RUN_FILE = "api/v1/run.mcap";

export class App {
  private readonly query = new URLSearchParams(location.search);
  private readonly token = this.query.get("token");
  private source: Source;
  private live: Live | undefined;
  private recordingName = "";
  private served = true;      // a server can be asked for lives
  private readonly player: Player;
  private readonly view: View;
  private readonly header: Header;
  private readonly agents: Agents;
  private readonly timeline: Timeline;
  private readonly inspector: Inspector;
  private readonly layers: Layers;
  private readonly news = new News();
  private readonly scale = make("li", { class: "scale" });
  private picked: Picked | undefined;
  private told: number[] | undefined;
  private followed: { name: string; through: boolean; last: Vector3 | undefined } | undefined;
  private panels_ms = 0;
  private tick_ms = performance.now();
  private preparing = false;

  constructor(root: HTMLElement) {
    startTheme();
    const canvas = make("div", { class: "stage" });
    const over = make("div", { class: "over" });
    root.append(canvas, over);
    this.view = new View(canvas, over);
    this.source = this.live = this.listen();
    this.player = new Player(this.source);
    const files = acceptFiles((file) => void this.open(file, file.name, false));
    this.header = new Header({
      fit: () => this.fit(), top: () => this.top(), theme: () => this.theme(), layers: () => this.layers.flip(),
      open: () => files.choose(), retry: () => this.live?.retry(),
    });
    this.agents = new Agents({
      select: (name) => this.select({ kind: "camera", name }), follow: (name) => this.follow(name, false),
      through: (name) => this.follow(name, true), opened: (name, open) => this.want(name, open),
      track: (agent, id) => this.select({ kind: "track", agent, id }),
    });
    this.timeline = new Timeline(this.source, this.player, () => { this.panels_ms = 0; });
    this.inspector = new Inspector(this.token);
    this.inspector.onClose = () => this.select(undefined);
    this.inspector.onLife = (life) => { this.told = life.covariance; };
    this.layers = new Layers(this.view);
    const legend = make("ul", { class: "legend" }, ...["static", "on trial", "moving"].map((text) => make("li", { class: text.replace(" ", "-") }, text)), this.scale);
    root.append(this.header.element, this.agents.element, this.inspector.element, this.layers.element, this.news.element, legend, this.timeline.element, files.hint);
    this.listenToHands(canvas);
    new ResizeObserver(() => this.inset()).observe(root);
    new ResizeObserver(() => this.inset()).observe(this.agents.element);
  }

  private inset(): void {
    const [stage, side] = [this.view.stage.renderer.domElement, this.agents.element].map((element) => element.getBoundingClientRect());
    const beside = side!.width < 0.6 * window.innerWidth;
    this.view.stage.inset(beside ? side!.right - stage!.left : 0, 0, beside ? 0 : side!.bottom - stage!.top, 0);
  }

  start(): void {
    const file = this.query.get("run") ?? (this.query.has("recorded") ? RUN_FILE : undefined);
    if (file !== undefined) void this.fetchRun(file);
    const tick = (now_ms: number) => {
      requestAnimationFrame(tick);
      this.tick(now_ms);
    };
    requestAnimationFrame(tick);
  }

  // The tracks of a camera are sent while its card is open.
  private want(name: string, tracks: boolean): void {
    const agent = this.view.state?.agents.find((each) => each.name === name);
    this.source.want(agent ? topicName(agent) : name, tracks);
  }

  private listen(): Live {
    const url = new URL("ws", location.href);
    url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    url.search = this.token === null ? "" : new URLSearchParams({ token: this.token }).toString();
    const live = new Live(url.href);
    live.onNewRun = () => {
      this.view.clear();
      this.news.note("A new run began.");
    };
    // `coslam view` shows a recorded run and may hear nobody.
    live.onFirstFailure = () => void this.fetchRun(RUN_FILE, true);
    return live;
  }

  private tick(now_ms: number): void {
    const passed_s = Math.min(0.5, (now_ms - this.tick_ms) / 1000);
    this.tick_ms = now_ms;
    this.player.advance(passed_s);
    if (this.source.live) this.view.show(this.source, this.player.t_s);
    else void this.showRecorded();
    this.keepUp();
    this.view.tick(now_ms);
    if (now_ms - this.panels_ms < PANELS_MS) return;
    this.panels_ms = now_ms;
    this.showPanels();
  }

  // Loads first; an instant that nobody waits for any more is passed over.
  private async showRecorded(): Promise<void> {
    if (this.preparing) return;
    this.preparing = true;
    const { source } = this;
    const t_s = this.player.t_s;
    try {
      await source.prepare(t_s);
      if (source === this.source) this.view.show(source, t_s);
    } finally {
      this.preparing = false;
    }
  }

  private showPanels(): void {
    const { view, live, player } = this;
    const state = view.state;
    this.header.showState(state);
    if (live?.recorded !== undefined && live === this.source) void this.fetchRun(live.recorded);
    const lags = state?.agents.filter(({ state: each }) => each === "tracking").map(({ lag_s }) => lag_s) ?? [];
    if (live) this.header.showLink(live, player, lags.length > 0 ? Math.max(...lags) : undefined, state?.finishing === true);
    else this.header.showRecording(this.recordingName);
    this.agents.show(state?.agents ?? [], (name) => view.colourOf(name), this.source.chronicle, player.shown_s);
    this.agents.showTracks(view.tracks);
    this.agents.mark(this.picked?.kind === "camera" ? this.picked.name : undefined, this.followed?.name, this.followed?.through ?? false);
    this.timeline.show((state?.agents ?? []).map(({ name }) => name));
    this.news.show(this.source.chronicle, player.mode === "live", player.shown_s);
    setText(this.scale, this.scaleText());
    this.showPicked();
  }

  private scaleText(): string {
    const { floor, unit, stage } = this.view;
    const grid = floor.cell > 0 ? `grid ${Number(floor.cell.toPrecision(3))} ${unit === "m" ? "m" : "units"}` : "";
    return this.query.has("stats") ? `${grid}  ${stage.frames_per_s.toFixed(0)} pictures/s at ${stage.pixelRatio().toFixed(2)}` : grid;
  }

  private showPicked(): void {
    const { picked, view } = this;
    this.inspector.onTime = (this.source.range.start_s < 1e8) ? (t_s) => this.player.seek(t_s) : undefined;
    this.inspector.show(picked && describe(view, picked, this.told), this.served);
    const { selection } = view;
    if (picked?.kind === "point") {
      const index = view.points.indexOf(picked.id);
      if (index < 0) return selection.hide();
      const { sigma, position } = view.points.figures(index);
      const each = (sigma * sigma) / 3;
      selection.show(view.frames.of(view.points.frameOf(index, view.frames)).group, position, this.told ?? [each, 0, 0, each, 0, each]);
    } else if (picked?.kind === "moving") {
      const { now, root } = view.moving;
      const at = now?.id.indexOf(picked.id) ?? -1;
      if (!now || at < 0 || !root.parent) return selection.hide();
      const each = (now.sigma[at]! ** 2) / 3;
      selection.show(view.frames.of(view.moving.frame).group, [...now.xyz.subarray(3 * at, 3 * at + 3)], [each, 0, 0, each, 0, each]);
    } else if (picked?.kind === "camera") {
      const mark = view.cameras.get(picked.name);
      if (!mark?.pose || !isKnown(mark.covariance)) return selection.hide();
      const { x, y, z } = mark.pose.position;
      selection.show(view.frames.of(mark.frame).group, [x, y, z], positionCovariance(mark.covariance));
    } else {
      selection.hide();
    }
    view.stage.invalidate();
  }

  private select(picked: Picked | undefined): void {
    this.picked = picked;
    this.told = undefined;
    this.panels_ms = 0;
    this.view.stage.invalidate();
  }

  private listenToHands(canvas: HTMLElement): void {
    let down: { x: number; y: number } | undefined;
    canvas.addEventListener("pointerdown", (event) => {
      this.layers.element.hidden = true;
      down = { x: event.clientX, y: event.clientY };
    });
    canvas.addEventListener("pointerup", (event) => {
      if (!down || Math.hypot(event.clientX - down.x, event.clientY - down.y) > CLICK_PX || event.button !== 0) return;
      const { left, top } = canvas.getBoundingClientRect();
      this.select(pick(this.view, event.clientX - left, event.clientY - top, event.pointerType === "touch"));
    });
    window.addEventListener("keydown", (event) => {
      if (event.target instanceof HTMLInputElement || event.ctrlKey || event.metaKey || event.altKey) return;
      this.key(event.key.toLowerCase(), event);
    });
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => {
      startTheme();
      this.repaint();
    });
  }

  private key(key: string, event: KeyboardEvent): void {
    const onButton = event.target instanceof HTMLButtonElement;
    if (key === "f") this.fit();
    else if (key === "t") this.top();
    else if (key === "l") this.player.goLive();
    else if (key === " " && !onButton) {
      this.player.toggle();
      event.preventDefault();
    } else if (key === "escape") {
      if (this.followed) this.follow(this.followed.name, this.followed.through);
      else this.select(undefined);
    } else if (/^[1-9]$/.test(key)) {
      const agent = this.view.state?.agents[Number(key) - 1];
      if (agent) this.follow(agent.name, false);
    }
    this.panels_ms = 0;
  }

  private fit(): void {
    this.unfollow();
    this.view.fit();
  }

  private top(): void {
    this.unfollow();
    this.view.fromAbove();
  }

  private theme(): void {
    flipTheme();
    this.repaint();
  }

  private repaint(): void {
    this.view.repaint();
    this.timeline.repaint();
    this.agents.redraw();
  }

  private unfollow(): void {
    if (this.followed?.through) {
      this.view.stage.resetLens();
      this.view.cameras.get(this.followed.name)?.tint(true);
    }
    this.followed = undefined;
  }

  // A second time: no longer.
  private follow(name: string, through: boolean): void {
    const again = this.followed?.name === name && this.followed.through === through;
    const wasThrough = this.followed?.through === true;
    this.unfollow();
    if (wasThrough && (again || !through)) this.view.fit();
    if (again) return;
    this.followed = { name, through, last: undefined };
    this.view.release();
    this.view.stage.invalidate();
  }

  // Moves with the camera that is followed.
  private keepUp(): void {
    const mark = this.followed && this.view.cameras.get(this.followed.name);
    if (!this.followed || !mark?.pose) return;
    const at = new Vector3().setFromMatrixPosition(mark.body.matrixWorld);
    if (this.followed.through) return this.view.lookThrough(mark);
    const { stage } = this.view;
    if (this.followed.last) {
      if (!this.followed.last.equals(at)) stage.shift(at.clone().sub(this.followed.last));
    } else {
      const away = stage.camera.position.clone().sub(stage.controls.target).setLength(0.8 * this.view.radius);
      stage.moveTo(at.clone().add(away), at.clone());
    }
    this.followed.last = at;
  }

  private async fetchRun(file: string, quietly = false): Promise<void> {
    if (this.live) this.live.recorded = undefined;
    const url = new URL(file, location.href);
    if (this.token !== null) url.searchParams.set("token", this.token);
    try {
      const response = await fetch(url);
      if (!response.ok) throw new Error(`the server answered ${response.status}`);
      await this.open(await response.blob(), "recorded run", true);
    } catch (error) {
      if (!quietly) this.news.note(`The recorded run cannot be shown: ${error instanceof Error ? error.message : String(error)}`, "lost");
    }
  }

  private async open(blob: Blob, name: string, served: boolean): Promise<void> {
    let source: Source;
    try {
      source = await openRecording(blob);
    } catch (error) {
      this.news.note(`${name} cannot be shown: ${error instanceof Error ? error.message : String(error)}`, "lost");
      return;
    }
    this.source.close();
    this.live = undefined;
    this.served = served;
    this.recordingName = name;
    this.source = source;
    this.select(undefined);
    this.unfollow();
    this.view.clear();
    this.agents.clear();
    this.player.take(source);
    this.timeline.take(source);
    this.news.forget(source.chronicle);
  }
}
