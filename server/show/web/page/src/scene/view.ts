// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The scene of one instant: takes the messages of that time from a source and draws what has changed.
import { Matrix4, Vector3 } from "three";

import type { Cloud } from "../data/cloud";
import { decode } from "../data/decode";
import type { Source } from "../data/source";
import { TOPIC, agentTopic, topicName, type MarkerArray, type Message, type Path, type PoseArray, type PoseEstimate, type RunState, type Tracks } from "../data/types";
import type { CameraMark } from "./cameras";
import { Fitting } from "./fitting";
import { Fleet } from "./fleet";
import { Frames } from "./frames";
import { Labels } from "./labels";
import { ALL_LAYERS, showLayers } from "./layers";
import { levelMaps, measureMaps } from "./levelling";
import { Ruler } from "./measure";
import { Moving, TRAIL_S } from "./moving";
import { Objects } from "./objects";
import { type Palette, readPalette } from "./palette";
import { Points } from "./points";
import type { ColourBy } from "./point_shader";
import { SelectionMark } from "./selection";
import { SoftPoints } from "./soft_points";
import { Stage } from "./stage";
import { Borders, Floor } from "./surroundings";

const STALE_S = 0.7;        // what moves is not shown after so long
const FRUSTUM = 0.045;      // of the size of the map
const POINT = 0.0042;
const MANY_POINTS = 20000;

export class View {
  readonly stage: Stage;
  readonly frames = new Frames();
  readonly points = new Points();
  readonly soft: SoftPoints | undefined;
  readonly moving = new Moving();
  readonly objects: Objects;
  readonly fleet: Fleet;
  readonly tracks = new Map<string, Tracks>();
  readonly selection: SelectionMark;
  readonly ruler: Ruler;
  readonly floor = new Floor();
  readonly fitting: Fitting;
  readonly labels: Labels;
  readonly shownLayers = { ...ALL_LAYERS };
  pointScale = 1;
  state: RunState | undefined;
  palette: Palette = readPalette();
  radius = 1;
  onDrawn: () => void = () => {};
  private readonly borders: Borders;
  private readonly shown = new Map<string, Message>();
  private shownFrames = -1;
  private shownEvents = 0;
  private source: Source | undefined;

  constructor(holder: HTMLElement, over: HTMLElement) {
    this.stage = new Stage(holder);
    this.labels = new Labels(over);
    this.fleet = new Fleet(this.labels, this.frames, this.palette);
    this.objects = new Objects(this.labels);
    this.selection = new SelectionMark(this.labels);
    this.ruler = new Ruler(this.labels);
    this.borders = new Borders(this.labels);
    this.fitting = new Fitting(this);
    const { scene } = this.stage;
    this.soft = this.stage.software ? new SoftPoints() : undefined;
    scene.add(this.frames.root, this.soft?.object ?? this.points.object, this.floor.object);
    for (const { strokes } of [this.fleet.links, this.fleet.happened, this.borders, this.ruler]) scene.add(strokes.object);
    this.stage.onDraw = () => this.beforeDraw();
    this.stage.onUserMove = () => this.fitting.release();
    this.repaint();
  }

  get cameras(): ReadonlyMap<string, CameraMark> { return this.fleet.marks; }

  // Of lengths in a frame.
  unitOf(frame: string): string {
    const metric = frame === "map" ? this.state?.scale_known !== false : this.frames.all.get(frame)?.ownUnit === false;
    return metric ? "m" : "units";
  }
  get unit(): string { return this.unitOf("map"); }

  clear(): void {
    this.shown.clear();
    this.tracks.clear();
    this.state = undefined;
    this.fleet.clear();
    this.objects.clear();
    this.points.clear();
    this.moving.root.visible = false;
    this.selection.hide();
    this.ruler.hide();
    this.frames.clear();
    this.borders.show([]);
    this.fitting.clear();
    this.stage.invalidate();
  }

  show(source: Source, t_s: number): void {
    this.source = source;
    const now_s = Math.min(t_s, source.range.end_s);
    let paths = false;
    for (const topic of source.topics()) {
      const message = source.last(topic, t_s);
      if (message === undefined) {
        this.forget(topic);
      } else if (message !== this.shown.get(topic)) {
        this.shown.set(topic, message);
        this.take(topic, message, source);
        paths ||= topic.endsWith("/path");
      }
    }
    if (paths) this.level();
    this.dropStale(now_s);
    const rearranged = this.frames.version !== this.shownFrames;
    if (rearranged) this.arrange();
    const events = source.chronicle.events.length;
    if (paths || rearranged || events !== this.shownEvents) this.drawHappened(now_s);
    this.shownEvents = events;
  }

  repaint(): void {
    this.palette = readPalette();
    this.stage.renderer.setClearColor(this.palette.background);
    for (const part of [this.points, this.moving, this.objects, this.floor, this.selection, this.borders, this.ruler]) part.paint(this.palette);
    this.soft?.paint(this.palette, this.points.by);
    this.fleet.paint(this.palette);
    this.fleet.drawLinks(this.state);
    this.drawHappened(this.state?.t_s ?? 0);
    this.stage.invalidate();
  }

  colourBy(by: ColourBy): void {
    this.points.colourBy(by);
    this.soft?.paint(this.palette, by);
    this.stage.invalidate();
  }

  // All cameras and points; the maps are put level again.
  fit(): void {
    this.level(true);
    this.arrange();
    this.fitting.fit();
  }

  colourOf(agent: string): string { return `var(--camera-${this.fleet.colourIndex(agent)})`; }

  tick(now_ms: number): void {
    if (this.points.fade(now_ms) && !this.soft) this.stage.invalidate();
    this.stage.tick(now_ms);
  }

  private take(topic: string, message: Message, source: Source): void {
    const [agent, what] = agentTopic(topic) ?? [];
    if (topic === TOPIC.state) this.takeState(decode<RunState>(message));
    else if (topic === TOPIC.points) this.takePoints(decode<Cloud>(message));
    else if (topic === TOPIC.moving) this.takeMoving(message, source);
    else if (topic === TOPIC.objects) this.takeObjects(message);
    else if (agent !== undefined && what === "tracks") this.takeTracks(this.nameOf(agent), message);
    else if (agent !== undefined) this.takePose(this.fleet.of(this.nameOf(agent)), what!, message);
    else return;
    this.stage.invalidate();
  }

  private takeState(state: RunState | undefined): void {
    if (!state) return;
    this.state = state;
    this.frames.takeState(state);
    this.fleet.takeState(state, this.source!.chronicle);
    this.fleet.drawLinks(state);
    this.frames.arrange();
  }

  private takePoints(cloud: Cloud | undefined): void {
    if (!cloud) return;
    this.points.apply(cloud);
    this.arrange();
  }

  private takeMoving(message: Message, source: Source): void {
    const samples = source.between(TOPIC.moving, message.t_s - TRAIL_S, message.t_s)
      .map((each) => ({ t_s: each.t_s, cloud: decode<Cloud>(each)! })).filter(({ cloud }) => cloud !== undefined);
    this.moving.show(samples, this.frames);
  }

  private takeObjects(message: Message): void {
    const array = decode<MarkerArray>(message);
    if (!array) return;
    this.objects.show(message.t_s, array, this.frames);
    this.objects.name(this.unit);
  }

  private takeTracks(agent: string, message: Message): void {
    const tracks = decode<Tracks>(message);
    if (tracks) this.tracks.set(agent, tracks);
  }

  private takePose(mark: CameraMark, what: string, message: Message): void {
    if (what === "pose") {
      const estimate = decode<PoseEstimate>(message);
      if (estimate) mark.takePose(estimate, this.frames);
    } else if (what === "key_frames") {
      const array = decode<PoseArray>(message);
      if (array) mark.takeKeyFrames(array, this.frames);
    } else {
      const path = decode<Path>(message);
      if (path) mark.takePath(path, this.frames);
    }
    this.fleet.drawLinks(this.state);
  }

  private forget(topic: string): void {
    if (!this.shown.delete(topic)) return;
    const [agent] = agentTopic(topic) ?? [];
    if (topic === TOPIC.points) this.points.clear();
    if (topic === TOPIC.objects) this.objects.clear();
    if (agent !== undefined) {
      const mark = this.cameras.get(this.nameOf(agent));
      if (mark) mark.body.visible = false;
      this.tracks.delete(this.nameOf(agent));
    }
    this.stage.invalidate();
  }

  private dropStale(now_s: number): void {
    for (const topic of [TOPIC.moving, TOPIC.objects]) {
      const message = this.shown.get(topic);
      if (!message || now_s - message.t_s < STALE_S) continue;
      this.shown.delete(topic);
      if (topic === TOPIC.objects) this.objects.clear();
      else this.moving.root.visible = false;
      this.stage.invalidate();
    }
  }

  private level(again = false): void {
    const paths = [...this.shown].flatMap(([topic, message]) => (agentTopic(topic)?.[1] === "path" ? [decode<Path>(message)] : []));
    levelMaps(this.frames, paths.filter((path) => path !== undefined), again);
  }

  private arrange(): void {
    measureMaps(this.frames, this.points, this.cameras.values());
    this.frames.arrange();
    this.shownFrames = this.frames.version;
    this.points.place(this.frames);
    const box = this.frames.extent();
    if (box.isEmpty()) return;
    const radius = 0.5 * box.getSize(new Vector3()).length();
    if (radius > 1.25 * this.radius || radius < 0.75 * this.radius) {
      this.radius = radius;
      this.stage.setDepth(radius);
    }
    this.fleet.scale(FRUSTUM * this.radius);
    this.borders.show(this.frames.shown());
    this.floor.fit(box);
    const { uniforms } = this.points.material;
    uniforms["radius"]!.value = this.radius;
    uniforms["floorHeight"]!.value = box.min.y;
    uniforms["ceilingHeight"]!.value = box.max.y;
    this.fleet.drawLinks(this.state);
    this.fitting.keep();
    this.stage.invalidate();
  }

  private beforeDraw(): void {
    const { uniforms } = this.points.material;
    // Few points are drawn larger, so that one sees what they are of.
    const sparse = Math.min(1.7, Math.max(1, Math.cbrt(MANY_POINTS / Math.max(1, this.points.count))));
    uniforms["size"]!.value = POINT * this.radius * this.pointScale * sparse;
    uniforms["smallest"]!.value = 1.3 * sparse * this.stage.pixelRatio();
    uniforms["pixelScale"]!.value = this.stage.pixelScale();
    this.moving.pixelRatio(this.stage.pixelRatio());
    for (const mark of this.cameras.values()) mark.placeLabel();
    this.objects.placeLabels();
    showLayers(this, this.shown.has(TOPIC.moving));
    this.stage.camera.updateMatrixWorld();
    const { camera } = this.stage;
    this.soft?.draw(this.points, camera, this.stage.renderer.domElement.width, this.stage.renderer.domElement.height, this.points.by, this.radius);
    this.labels.place(this.stage);
    this.onDrawn();
  }

  // The agent whose channels have that name.
  private nameOf(topic: string): string { return this.state?.agents.find((agent) => topicName(agent) === topic)?.name ?? topic; }

  private drawHappened(t_s: number): void { this.fleet.drawHappened(this.source?.chronicle.events ?? [], t_s); }

  // Where things are on the screen, by clip coordinates.
  clip(): Matrix4 { return new Matrix4().multiplyMatrices(this.stage.camera.projectionMatrix, this.stage.camera.matrixWorldInverse); }
}
