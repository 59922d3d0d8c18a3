// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Holds the page together: source, player, view and what stands around it.
import { Live } from "./data/live";
import { openRecording } from "./data/recording";
import type { Source } from "./data/source";
import { topicName } from "./data/types";
import { Following } from "./follow";
import { listenToHands } from "./hands";
import { Picking } from "./picking";
import { Player } from "./player";
import { download, pictureOf, plyOf } from "./save";
import { pick } from "./scene/pick";
import { View } from "./scene/view";
import { Agents } from "./ui/agents";
import { clock, gridText, make } from "./ui/dom";
import { acceptFiles } from "./ui/files";
import { Gizmo } from "./ui/gizmo";
import { Header, NO_SCALE } from "./ui/header";
import { Help } from "./ui/help";
import { Inspector } from "./ui/inspector";
import { Layers } from "./ui/layers";
import { Legend } from "./ui/legend";
import { News } from "./ui/news";
import { Notice, noticeOf } from "./ui/notice";
import { flipTheme, startTheme } from "./ui/theme";
import { Timeline } from "./ui/timeline";

const PANELS_MS = 100;    // how often figures are written
const RUN_FILE = "api/v1/run.mcap";
const ASK = "api/v1/groups";  // answered to whom may read

export class App {
  private readonly query = new URLSearchParams(location.search);
  private readonly token = this.query.get("token");
  private source: Source;
  private live: Live | undefined;
  private recordingName = "";
  private served = true;      // a server can be asked for lives
  private readonly player: Player;
  private readonly view: View;
  private readonly following: Following;
  private readonly picking: Picking;
  private readonly header: Header;
  private readonly agents: Agents;
  private readonly timeline: Timeline;
  private readonly inspector: Inspector;
  private readonly layers: Layers;
  private readonly legend: Legend;
  private readonly gizmo: Gizmo;
  private readonly help = new Help();
  private readonly news = new News();
  private readonly notice = new Notice(() => this.live?.retry());
  private panels_ms = 0;
  private tick_ms = performance.now();
  private preparing = false;

  constructor(root: HTMLElement) {
    startTheme();
    const canvas = make("div", { class: "stage" });
    const over = make("div", { class: "over" });
    root.append(canvas, over);
    this.view = new View(canvas, over);
    this.following = new Following(this.view);
    this.source = this.live = this.listen();
    this.player = new Player(this.source);
    const files = acceptFiles((file) => void this.open(file, file.name, false));
    this.header = new Header({
      fit: () => this.look(() => this.view.fit()), top: () => this.look(() => this.view.fitting.flip()), theme: () => this.theme(),
      layers: () => this.layers.flip(), help: () => this.help.flip(), scale: () => this.news.note(NO_SCALE),
    });
    this.agents = new Agents({
      select: (name) => this.change(() => this.picking.pick({ kind: "camera", name })), follow: (name) => this.following.follow(name, false),
      through: (name) => this.following.follow(name, true), opened: (name, open) => this.want(name, open),
      track: (agent, id) => this.change(() => this.picking.pick({ kind: "track", agent, id })),
    }, this.token);
    this.timeline = new Timeline(this.source, this.player, (name) => this.view.fleet.colourIndex(name), () => { this.panels_ms = 0; });
    this.inspector = new Inspector(this.token);
    this.picking = new Picking(this.view, this.inspector, canvas);
    this.layers = new Layers(this.view, { picture: () => void this.savePicture(), map: () => this.saveMap(), open: () => files.choose() });
    this.legend = new Legend(this.view);
    this.gizmo = new Gizmo(this.view);
    this.view.onDrawn = () => this.gizmo.draw();
    const news = make("div", { class: "news" }, this.notice.element, this.news.element);
    const corner = make("div", { class: "corner" }, this.gizmo.element, this.legend.element);
    root.append(this.header.element, this.agents.element, this.inspector.element, this.layers.element, news, corner, this.timeline.element, files.hint, this.help.element);
    this.listenToHands(canvas);
    new ResizeObserver(() => this.inset()).observe(root);
    new ResizeObserver(() => this.inset()).observe(this.agents.element);
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

  // What stands beside the picture, or above it where there is no room beside.
  private inset(): void {
    const [stage, side] = [this.view.stage.renderer.domElement, this.agents.element].map((element) => element.getBoundingClientRect());
    const beside = side!.width < 0.6 * window.innerWidth;
    const empty = side!.height === 0 || this.agents.element.childElementCount === 0;
    this.view.stage.inset(beside && !empty ? side!.right - stage!.left : 0, 0, beside || empty ? 0 : side!.bottom - stage!.top, 0);
  }

  // The tracks of a camera are sent while its card is open.
  private want(name: string, tracks: boolean): void {
    const agent = this.view.state?.agents.find((each) => each.name === name);
    this.source.want(agent ? topicName(agent) : name, tracks);
  }

  // With the token that the page was called with.
  private addressOf(path: string): URL {
    const url = new URL(path, location.href);
    if (this.token !== null) url.searchParams.set("token", this.token);
    return url;
  }

  private listen(): Live {
    const url = this.addressOf("ws");
    url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    const live = new Live(url.href, this.addressOf(ASK).href);
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
    this.following.keepUp();
    this.view.tick(now_ms);
    if (now_ms - this.panels_ms < PANELS_MS) return;
    this.panels_ms = now_ms;
    this.showPanels(now_ms);
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

  private showPanels(now_ms: number): void {
    const { view, live, player, source: { chronicle } } = this;
    const state = view.state;
    const t_s = player.shown_s;
    const lagHolds = live?.lagHolds() ?? true;
    this.header.showState(state, chronicle, t_s);
    if (live?.recorded !== undefined && live === this.source) void this.fetchRun(live.recorded);
    const lags = state?.agents.flatMap(({ state: each, lag_s }) => (each === "tracking" && lag_s !== null ? [lag_s] : [])) ?? [];
    if (live) this.header.showLink(live, player, lags.length > 0 ? Math.max(...lags) : undefined, state?.finishing === true);
    else this.header.showRecording(this.recordingName);
    this.notice.show(live && player.mode === "live" ? noticeOf(live, state, now_ms) : undefined);
    this.agents.show(state, (name) => view.colourOf(name), chronicle, t_s, lagHolds, live !== undefined && live.link.kind !== "over" && player.mode === "live");
    this.agents.showTracks(view.tracks);
    const { now } = this.following;
    this.agents.mark(this.picking.first?.kind === "camera" ? this.picking.first.name : undefined, now?.name, now?.through ?? false);
    this.timeline.show((state?.agents ?? []).map(({ name }) => name), live !== undefined && live.link.kind !== "over");
    this.news.show(chronicle, player.mode === "live", t_s);
    this.legend.show();
    this.gizmo.draw();
    this.inspector.onTime = this.source.range.start_s < 1e8 ? (at_s) => player.seek(at_s) : undefined;
    this.picking.show(this.served && !(live?.link.kind === "over" || live?.link.kind === "lost"));
  }

  private listenToHands(canvas: HTMLElement): void {
    listenToHands(canvas, {
      down: () => { this.layers.element.hidden = true; },
      pick: (x, y, finger, more) => this.change(() => this.picking.pick(pick(this.view, x, y, finger), more)),
      key: (key) => this.key(key),
    });
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => {
      startTheme();
      this.repaint();
    });
  }

  private key(key: string): boolean {
    const { view, player, following, picking } = this;
    const keys: Record<string, () => void> = {
      "f": () => this.look(() => view.fit()), "t": () => this.look(() => view.fitting.flip()), "p": () => this.look(() => view.fitting.side()),
      "m": () => picking.measure(), "l": () => player.goLive(), " ": () => player.toggle(), "s": () => void this.savePicture(), "?": () => this.help.flip(),
      "escape": () => { if (following.now) following.follow(following.now.name, following.now.through); else picking.letGo(); },
    };
    const agent = /^[1-9]$/.test(key) ? view.state?.agents[Number(key) - 1] : undefined;
    const act = agent ? () => following.follow(agent.name, false) : keys[key];
    if (act) this.change(act);
    return act !== undefined;
  }

  // Panels show it at once.
  private change(act: () => void): void {
    act();
    this.panels_ms = 0;
    this.view.stage.invalidate();
  }

  // From another side: nobody is followed any more.
  private look(act: () => void): void {
    this.following.end();
    act();
  }

  private theme(): void {
    flipTheme();
    this.repaint();
  }

  private repaint(): void {
    this.view.repaint();
    for (const part of [this.agents, this.header, this.gizmo]) part.redraw();
    this.timeline.repaint();
  }

  private async savePicture(): Promise<void> {
    const { view, player, source } = this;
    const { floor, unit, state } = view;
    const t_s = player.shown_s - (source.range.start_s > 1e8 ? source.range.start_s : 0);
    const run = state && state.run !== "" ? `run ${state.run.slice(0, 8)}` : this.recordingName;
    const caption = ["CoSLAM", run, clock(t_s), `${state?.server.points ?? 0} points`, gridText(floor.cell, unit)].filter((part) => part !== "").join("   ");
    download(await pictureOf(view, caption), "coslam.png");
  }

  private saveMap(): void {
    const { points, unit } = this.view;
    download(new Blob([plyOf(points.proven(), unit)], { type: "application/octet-stream" }), "map.ply");
  }

  private async fetchRun(file: string, quietly = false): Promise<void> {
    if (this.live) this.live.recorded = undefined;
    try {
      const response = await fetch(this.addressOf(file));
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
    this.picking.pick(undefined);
    this.following.end();
    this.view.clear();
    this.agents.clear();
    this.player.take(source);
    this.timeline.take(source);
    this.news.forget(source.chronicle);
  }
}
