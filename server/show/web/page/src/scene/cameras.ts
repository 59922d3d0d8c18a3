// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Cameras: a frustum in the camera's colour, the way it came, its name. One without a pose stays where it was, dashed.
import { BufferAttribute, BufferGeometry, Color, DoubleSide, Group, Matrix4, Mesh, MeshBasicMaterial, Vector3 } from "three";

import type { Standing } from "../data/chronicle";
import { countUntil } from "../data/source";
import { secondsOf, type AgentState, type Path, type Pose, type PoseArray, type PoseEstimate } from "../data/types";
import { type Frames, lookOf } from "./frames";
import { type Label, Label as LabelOf, type Labels } from "./labels";
import { Strokes, strip } from "./lines";
import type { Palette } from "./palette";

const KEY_FRAME_SIZE = 0.4;  // of a camera
const OFF_WAY_S = 10;  // what is longer after a pose was elsewhere

// The corners of the image at a depth of one, from the top left, clockwise.
function cornersOf(fov: readonly number[]): [number[], number[], number[], number[]] {
  const [width = 4, height = 3, fx = 3, fy = 3, cx = 2, cy = 1.5] = fov;
  const ray = (u: number, v: number) => [(u - cx) / fx, (v - cy) / fy, 1];
  return [ray(0, 0), ray(width, 0), ray(width, height), ray(0, height)];
}

// Beside its name.
const DETAIL: Record<Standing, string> = { tracking: "", relative: "by what moves", lost: "lost", none: "", unheard: "no images", gone: "left", ended: "" };

export class CameraMark {
  readonly body = new Group();
  readonly label: Label;
  readonly trail = new Strokes(2, { opacity: 0.85 });
  readonly keyFrames = new Strokes(1, { opacity: 0.5 });
  frame = "";
  pose: Pose | undefined;
  covariance: ArrayLike<number> | undefined;
  state: AgentState | undefined;
  standing: Standing = "none";
  private readonly edges = new Strokes(2);
  private readonly broken = new Strokes(2, { dashed: true });
  private readonly face: Mesh;
  private path: Path | undefined;
  private keyPoses: readonly Pose[] = [];
  private lens = "";
  private size = 1;

  constructor(readonly name: string, labels: Labels) {
    this.label = labels.add(new LabelOf("camera"));
    this.label.visible = false;
    this.label.element.dataset["camera"] = name;
    const material = new MeshBasicMaterial({ transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false });
    this.face = new Mesh(new BufferGeometry(), material);
    this.body.add(this.edges.object, this.broken.object, this.face);
    this.body.visible = false;
    this.body.matrixAutoUpdate = false;
  }

  takeState(state: AgentState, standing: Standing): void {
    this.state = state;
    this.standing = standing;
    const lens = state.fov.join();
    if (lens === this.lens) return;
    this.lens = lens;
    this.shape(state.fov);
  }

  takePose({ header, pose }: PoseEstimate, frames: Frames): void {
    this.pose = pose.pose;
    this.covariance = pose.covariance;
    this.move(header.frame_id, frames);
    this.drawTrail();
  }

  takePath(path: Path, frames: Frames): void {
    this.path = path;
    const last = path.poses.at(-1);
    if (!this.pose && last) {
      this.pose = last.pose;
      this.move(path.header.frame_id, frames);
    }
    frames.of(path.header.frame_id).group.add(this.trail.object);
    this.drawTrail();
  }

  takeKeyFrames({ header, poses }: PoseArray, frames: Frames): void {
    this.keyPoses = poses;
    frames.of(header.frame_id).group.add(this.keyFrames.object);
    this.drawKeyFrames();
  }

  scale(size: number): void {
    const changed = size !== this.size;
    this.size = size;
    this.place();
    if (changed) this.drawKeyFrames();
  }

  paint(colour: Color, palette: Palette): void {
    const { standing } = this;
    const holds = standing === "tracking" || standing === "ended";
    const shown = { lost: palette.lost, gone: palette.gone, unheard: palette.gone, relative: palette.relative }[standing as string] ?? colour;
    this.edges.object.visible = holds;
    this.broken.object.visible = !holds;
    for (const strokes of [this.edges, this.broken]) strokes.paint(shown);
    this.trail.paint(colour);
    this.keyFrames.paint(colour);
    (this.face.material as MeshBasicMaterial).color.copy(shown);
    this.label.element.style.setProperty("--colour", `#${colour.getHexString()}`);
    this.label.element.classList.toggle("lost", standing === "lost");
    this.label.text(this.name, DETAIL[standing]);
  }

  // The image plane is tinted, but not for one who looks through it.
  tint(on: boolean): void { this.face.visible = on; }

  placeLabel(): void {
    this.label.visible = this.pose !== undefined && this.body.parent?.visible === true;
    if (this.label.visible) this.label.place.setFromMatrixPosition(this.body.matrixWorld);
  }

  private move(frameName: string, frames: Frames): void {
    const frame = frames.of(frameName);
    if (this.frame !== frameName) {
      this.frame = frameName;
      frame.group.add(this.body);
      frame.group.add(this.trail.object);
    }
    this.body.visible = true;
    this.place();
  }

  private place(): void {
    if (!this.pose) return;
    const { position } = this.pose;
    const scale = new Vector3(this.size, this.size, this.size);
    this.body.matrix.copy(new Matrix4().compose(new Vector3(position.x, position.y, position.z), lookOf(this.pose), scale));
    this.body.updateMatrixWorld(true);
  }

  // Where it was at that time, in its frame; undefined: not on its way.
  placeAt(t_s: number): Vector3 | undefined {
    if (this.path?.header.frame_id !== this.frame) return undefined;
    const { poses } = this.path;
    const at = countUntil(poses.length, (i) => secondsOf(poses[i]!.header), t_s) - 1;
    if (at < 0 || t_s - secondsOf(poses[at]!.header) > OFF_WAY_S) return undefined;
    const { x, y, z } = poses[at]!.pose.position;
    return new Vector3(x, y, z);
  }

  // Where it was, in its frame.
  places(): Vector3[] {
    const poses = this.path?.header.frame_id === this.frame ? this.path.poses.map(({ pose }) => pose) : [];
    return [...poses, ...(this.pose ? [this.pose] : [])].map(({ position: p }) => new Vector3(p.x, p.y, p.z));
  }

  private drawTrail(): void { this.trail.set(strip(this.places().map((place) => place.toArray()))); }

  // Small image planes.
  private drawKeyFrames(): void {
    const [a, b, c, d] = cornersOf(this.state?.fov ?? []).map((corner) => new Vector3(...corner));
    const side = KEY_FRAME_SIZE * this.size;
    const matrix = new Matrix4();
    this.keyFrames.set(this.keyPoses.flatMap((pose) => {
      const { x, y, z } = pose.position;
      matrix.compose(new Vector3(x, y, z), lookOf(pose), new Vector3(side, side, side));
      const [p, q, r, s] = [a!, b!, c!, d!].map((corner) => corner.clone().applyMatrix4(matrix).toArray());
      return [p!, q!, q!, r!, r!, s!, s!, p!].flat();
    }));
  }

  private shape(fov: readonly number[]): void {
    const [a, b, c, d] = cornersOf(fov);
    const o = [0, 0, 0];
    const top = [(a[0]! + b[0]!) / 2, a[1]! * 1.45, 1];
    const lines = [o, a, o, b, o, c, o, d, a, b, b, c, c, d, d, a, a, top, top, b].flat();
    this.edges.set(lines);
    this.broken.set(lines);
    this.broken.material.dashSize = this.broken.material.gapSize = 0.14;
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array([...a, ...b, ...c, ...a, ...c, ...d]), 3));
    this.face.geometry.dispose();
    this.face.geometry = geometry;
  }
}
