// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The scene of one instant: takes the messages of that time from a source and draws what has changed.
import { Box3, Matrix4, Vector3 } from "three";

import type { Cloud } from "../data/cloud";
import { decode } from "../data/decode";
import type { Source } from "../data/source";
import { TOPIC, agentTopic, topicName, type MarkerArray, type Message, type Path, type Pose, type PoseEstimate, type RunState, type Tracks } from "../data/types";
import { CameraMark } from "./cameras";
import { Frames } from "./frames";
import { Labels } from "./labels";
import { Moving, TRAIL_S } from "./moving";
import { Objects } from "./objects";
import { type Palette, readPalette } from "./palette";
import { Points } from "./points";
import type { ColourBy } from "./point_shader";
import { SelectionMark } from "./selection";
import { SoftPoints } from "./soft_points";
import { Stage } from "./stage";
import { Floor, Links } from "./surroundings";

const STALE_S = 0.7;        // what moves is not shown after so long
const FRUSTUM = 0.045;      // of the size of the map
const POINT = 0.0042;
const MANY_POINTS = 20000;
const ENOUGH_POINTS = 50;   // to fit the view to
const FIT_POINTS = 1500;
const REFIT = 0.12;         // of the size of the map: it has grown by so much
const FIRST_VIEW = new Vector3(0.35, 0.72, 1);

export class View {
  readonly stage: Stage;
  readonly frames = new Frames();
  readonly points = new Points();
  private readonly soft: SoftPoints | undefined;
  readonly moving = new Moving();
  readonly objects: Objects;
  readonly cameras = new Map<string, CameraMark>();
  readonly tracks = new Map<string, Tracks>();
  readonly selection: SelectionMark;
  readonly floor = new Floor();
  readonly links = new Links();
  readonly shownLayers = { "Static points": true, "Moving points": true, Objects: true, Trails: true, Links: true, Floor: true, Names: true };
  pointScale = 1;
  state: RunState | undefined;
  palette: Palette = readPalette();
  radius = 1;
  private readonly labels: Labels;
  private readonly shown = new Map<string, Message>();
  private shownFrames = -1;
  private fitting = true;
  private readonly fitted = new Box3();

  constructor(holder: HTMLElement, over: HTMLElement) {
    this.stage = new Stage(holder);
    this.labels = new Labels(over);
    this.objects = new Objects(this.labels);
    this.selection = new SelectionMark(this.labels);
    const { scene } = this.stage;
    this.soft = this.stage.software ? new SoftPoints() : undefined;
    scene.add(this.frames.root, this.soft?.object ?? this.points.object, this.floor.object, this.links.strokes.object);
    this.stage.onDraw = () => this.beforeDraw();
    this.stage.onUserMove = () => this.release();
    this.repaint();
  }

  get unit(): string { return this.state?.scale_known === false ? "u" : "m"; }

  clear(): void {
    this.shown.clear();
    this.tracks.clear();
    this.state = undefined;
    for (const mark of this.cameras.values()) this.removeCamera(mark);
    this.cameras.clear();
    this.objects.clear();
    this.points.clear();
    this.moving.root.visible = false;
    this.links.show([], this.palette, 1);
    this.selection.hide();
    this.frames.clear();
    this.fitting = true;
    this.fitted.makeEmpty();
    this.stage.invalidate();
  }

  show(source: Source, t_s: number): void {
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
    if (this.frames.version !== this.shownFrames) this.arrange();
  }

  repaint(): void {
    this.palette = readPalette();
    this.stage.renderer.setClearColor(this.palette.background);
    for (const part of [this.points, this.moving, this.objects, this.floor, this.selection]) part.paint(this.palette);
    this.soft?.paint(this.palette, this.points.by);
    this.paintCameras();
    this.drawLinks();
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
    this.fitted.copy(this.frames.extent());
    this.stage.fit(this.places(), this.fitting ? FIRST_VIEW : undefined);
    this.fitting = true;
  }

  fromAbove(): void {
    this.release();
    this.stage.fromAbove(this.places());
  }

  // Some of all that is shown, without what lies far out.
  private places(): Vector3[] {
    const box = this.frames.extent();
    const out: Vector3[] = [];
    for (const mark of this.cameras.values()) {
      const { parent } = mark.body;
      if (!parent || !mark.body.visible || !parent.visible) continue;
      const places = mark.places();
      out.push(...places.filter((_, i) => i % 8 === 0 || i === places.length - 1).map((place) => place.applyMatrix4(parent.matrixWorld)));
    }
    const stride = Math.max(1, Math.floor(this.points.count / FIT_POINTS));
    for (let i = 0; i < this.points.count; i += stride) {
      const place = this.points.placeOf(i);
      if (box.containsPoint(place)) out.push(place);
    }
    return out;
  }

  // From now on the view is somebody's choice.
  release(): void { this.fitting = false; }

  colourOf(agent: string): string { return `var(--group-${this.groupOf(agent) % this.palette.groups.length})`; }

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
    else if (agent !== undefined) this.takePose(this.camera(this.nameOf(agent)), what!, message);
    else return;
    this.stage.invalidate();
  }

  private takeState(state: RunState | undefined): void {
    if (!state) return;
    this.state = state;
    this.frames.takeState(state);
    for (const agent of state.agents) this.camera(agent.name).takeState(agent);
    for (const [name, mark] of this.cameras) {
      if (state.agents.some((agent) => agent.name === name)) continue;
      this.removeCamera(mark);
      this.cameras.delete(name);
    }
    this.paintCameras();
    this.drawLinks();
    this.frames.arrange();
  }

  private takePoints(cloud: Cloud | undefined): void {
    if (!cloud) return;
    this.points.apply(cloud);
    this.arrange();
    this.keepFitted();
  }

  // All is kept in sight until somebody chooses another view.
  private keepFitted(): void {
    const box = this.frames.extent();
    if (!this.fitting || this.points.count < ENOUGH_POINTS || box.isEmpty()) return;
    const moved = this.fitted.min.distanceTo(box.min) + this.fitted.max.distanceTo(box.max);
    if (!this.fitted.isEmpty() && moved < REFIT * box.getSize(new Vector3()).length()) return;
    this.stage.fit(this.places(), this.fitted.isEmpty() ? FIRST_VIEW : undefined);
    this.fitted.copy(box);
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
    } else {
      const path = decode<Path>(message);
      if (path) mark.takePath(path, this.frames);
    }
    this.drawLinks();
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
    const poses = new Map<string, { all: Pose[]; from_s: number; to_s: number }>();
    for (const [topic, message] of this.shown) {
      const path = agentTopic(topic)?.[1] === "path" ? decode<Path>(message) : undefined;
      if (!path || path.poses.length === 0) continue;
      const times = [path.poses[0]!, path.poses.at(-1)!].map(({ header: { stamp } }) => stamp.sec + (stamp.nsec ?? stamp.nanosec ?? 0) / 1e9);
      const own = poses.get(path.header.frame_id) ?? { all: [], from_s: Infinity, to_s: -Infinity };
      own.all.push(...path.poses.map(({ pose }) => pose));
      poses.set(path.header.frame_id, { all: own.all, from_s: Math.min(own.from_s, times[0]!), to_s: Math.max(own.to_s, times[1]!) });
    }
    for (const [name, { all, from_s, to_s }] of poses) {
      this.frames.level(name, all, again);
      this.frames.settle(name, to_s - from_s);
    }
  }

  // How much room each map takes.
  private measure(): void {
    for (const frame of this.frames.all.values()) frame.extent.makeEmpty();
    this.points.measureFrames(this.frames);
    for (const mark of this.cameras.values()) {
      const frame = this.frames.all.get(mark.frame);
      if (!frame) continue;
      for (const place of mark.places()) frame.extent.expandByPoint(place.applyQuaternion(frame.turned));
    }
  }

  private arrange(): void {
    this.measure();
    this.frames.arrange();
    this.shownFrames = this.frames.version;
    this.points.place(this.frames);
    const box = this.frames.extent();
    if (box.isEmpty()) return;
    const radius = 0.5 * box.getSize(new Vector3()).length();
    if (radius > 1.25 * this.radius || radius < 0.75 * this.radius) {
      this.radius = radius;
      this.stage.setDepth(radius);
      for (const mark of this.cameras.values()) mark.scale(FRUSTUM * radius);
    }
    this.floor.fit(box);
    const { uniforms } = this.points.material;
    uniforms["radius"]!.value = this.radius;
    uniforms["floorHeight"]!.value = box.min.y;
    uniforms["ceilingHeight"]!.value = box.max.y;
    this.stage.invalidate();
  }

  // As that camera sees it, with its lens.
  lookThrough(mark: CameraMark): void {
    const { stage } = this;
    const [, height = 3, , fy = 3] = mark.state?.fov ?? [];
    const turned = new Matrix4().multiplyMatrices(mark.body.matrixWorld, new Matrix4().makeRotationX(Math.PI));
    const { camera, controls } = stage;
    mark.tint(false);
    const scale = new Vector3();
    turned.decompose(camera.position, camera.quaternion, scale);
    controls.enabled = false;
    controls.target.copy(camera.position).add(new Vector3(0, 0, -this.radius).applyQuaternion(camera.quaternion));
    const fov = (360 / Math.PI) * Math.atan(height / (2 * fy));
    if (Math.abs(camera.fov - fov) > 1e-3) {
      camera.fov = fov;
      camera.updateProjectionMatrix();
    }
    stage.invalidate();
  }

  private showLayers(): void {
    const layers = this.shownLayers;
    this.points.object.visible = layers["Static points"];
    if (this.soft) this.soft.object.visible = layers["Static points"];
    this.moving.root.visible = layers["Moving points"] && this.shown.has(TOPIC.moving);
    for (const mark of this.objects.all.values()) {
      mark.body.visible = layers.Objects;
      mark.label.visible = layers.Objects && layers.Names && mark.label.visible;
      mark.trail.object.visible = layers.Trails;
    }
    for (const mark of this.cameras.values()) {
      mark.trail.object.visible = layers.Trails;
      mark.label.visible &&= layers.Names;
    }
    this.links.strokes.object.visible = layers.Links && (this.state?.links.length ?? 0) > 0;
    this.floor.object.visible = layers.Floor;
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
    this.showLayers();
    this.stage.camera.updateMatrixWorld();
    const { camera } = this.stage;
    this.soft?.draw(this.points, camera, this.stage.renderer.domElement.width, this.stage.renderer.domElement.height, this.points.by, this.radius);
    this.labels.place(this.stage);
  }

  // The agent whose channels have that name.
  private nameOf(topic: string): string { return this.state?.agents.find((agent) => topicName(agent) === topic)?.name ?? topic; }

  private camera(name: string): CameraMark {
    let mark = this.cameras.get(name);
    if (!mark) {
      this.cameras.set(name, (mark = new CameraMark(name, this.labels)));
      mark.scale(FRUSTUM * this.radius);
      this.paintCameras();
    }
    return mark;
  }

  private removeCamera(mark: CameraMark): void {
    this.labels.remove(mark.label);
    mark.body.removeFromParent();
    mark.trail.object.removeFromParent();
  }

  // A group has the colour of the first of its names.
  private groupOf(agent: string): number {
    const names = (this.state?.agents ?? []).map(({ name }) => name).sort();
    const group = this.state?.groups.find((members) => members.includes(agent)) ?? [agent];
    return Math.max(0, names.indexOf([...group].sort()[0]!));
  }

  private paintCameras(): void {
    for (const [name, mark] of this.cameras) mark.paint(this.palette.groups[this.groupOf(name) % this.palette.groups.length]!, this.palette);
  }

  private drawLinks(): void {
    const links = (this.state?.links ?? []).flatMap(([a, b, shared]) => {
      const [from, to] = [this.cameras.get(a), this.cameras.get(b)].map((mark) => (mark?.pose && mark.body.parent ? mark : undefined));
      return from && to ? [{ from: placeOf(from), to: placeOf(to), shared }] : [];
    });
    this.links.show(links, this.palette, FRUSTUM * this.radius);
  }

  // Where things are on the screen, by clip coordinates.
  clip(): Matrix4 { return new Matrix4().multiplyMatrices(this.stage.camera.projectionMatrix, this.stage.camera.matrixWorldInverse); }
}

function placeOf(mark: CameraMark): Vector3 { return new Vector3().setFromMatrixPosition(mark.body.matrixWorld); }
