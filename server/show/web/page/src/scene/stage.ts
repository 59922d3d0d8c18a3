// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The picture: renderer, viewer's camera and how it is moved. Draws only when something has changed.
import { Box3, Matrix4, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const FOV_DEG = 40;
const MARGIN = 1.06;
const CENTERINGS = 4;
const GLIDE_MS = 450;
const SLOW_MS = 45;         // a picture that takes longer is drawn with fewer pixels
const STILL_MS = 250;

// True where the processor draws, which smooths no edges. ?points=gpu and ?points=cpu say it for tests.
function drawsInSoftware(): boolean {
  const asked = new URLSearchParams(location.search).get("points");
  if (asked !== null) return asked === "cpu";
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(gl!.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

// Without transparency, which three.js would ask for and the browser then has to blend.
function opaqueCanvas(antialias: boolean): { canvas: HTMLCanvasElement; context: WebGL2RenderingContext } {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("webgl2", { alpha: false, antialias, stencil: false, powerPreference: "high-performance" });
  if (!context) throw new Error("WebGL 2 is not to be had here");
  return { canvas, context };
}

interface Glide { from: Vector3; to: Vector3; targetFrom: Vector3; targetTo: Vector3; began_ms: number }

export class Stage {
  readonly software: boolean;
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(FOV_DEG, 1, 0.01, 1000);
  readonly renderer: WebGLRenderer;
  readonly controls: OrbitControls;
  onDraw: () => void = () => {};
  onUserMove: () => void = () => {};
  onResize: () => void = () => {};
  frames_per_s = 0;
  width = 1;
  height = 1;
  private insets = { left: 0, right: 0, top: 0, bottom: 0 };
  private changed = true;
  private glide: Glide | undefined;
  private held = false;       // by somebody who may turn it, or only click
  private ratio = 1;
  private readonly bestRatio: number;
  private drawn_ms = 0;
  private moved_ms = 0;
  private readonly times_ms: number[] = [];

  constructor(private readonly holder: HTMLElement) {
    this.software = drawsInSoftware();
    this.renderer = new WebGLRenderer(opaqueCanvas(!this.software));
    this.bestRatio = this.software ? 1 : Math.min(2, window.devicePixelRatio);
    this.ratio = this.bestRatio;
    holder.append(this.renderer.domElement);
    this.renderer.domElement.setAttribute("aria-label", "the map");
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.15;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => {
      this.moved_ms = performance.now();
      this.invalidate();
      if (this.held) this.onUserMove();
    });
    this.controls.addEventListener("start", () => {
      this.glide = undefined;
      this.held = true;
    });
    this.controls.addEventListener("end", () => { this.held = false; });
    this.camera.position.set(0, 3, 6);
    new ResizeObserver(() => this.resize()).observe(holder);
    this.resize();
  }

  invalidate(): void { this.changed = true; }

  // At once, so that the picture can be read.
  drawNow(): void {
    this.changed = false;
    this.onDraw();
    this.renderer.render(this.scene, this.camera);
  }

  // How many pixels a length of one at a distance of one takes.
  pixelScale(): number { return (this.height * this.ratio) / (2 * Math.tan((this.camera.fov * Math.PI) / 360)); }
  pixelRatio(): number { return this.ratio; }

  tick(now_ms: number): void {
    this.stepGlide(now_ms);
    if (this.controls.enabled) this.controls.update();
    if (this.ratio < this.bestRatio && now_ms - this.moved_ms > STILL_MS && !this.glide) this.setRatio(this.bestRatio);
    if (!this.changed) return;
    this.drawNow();
    this.measure(now_ms);
  }

  // Looks at all of these places, from where the viewer stands or from `from` (a direction).
  fit(places: readonly Vector3[], from?: Vector3): void {
    if (places.length === 0) return;
    const back = (from?.clone() ?? this.camera.position.clone().sub(this.controls.target)).normalize();
    const { target, distance } = this.plan(places, back);
    this.moveTo(target.clone().addScaledVector(back, MARGIN * distance), target);
    const box = new Box3().setFromPoints(places as Vector3[]);
    this.setDepth(Math.max(1e-3, 0.5 * box.getSize(new Vector3()).length()));
  }

  // Where to look at, and from how far, so that all of these places are just in the picture.
  plan(places: readonly Vector3[], back: Vector3): { target: Vector3; distance: number } {
    const target = new Box3().setFromPoints(places as Vector3[]).getCenter(new Vector3());
    const axes = new Matrix4().lookAt(back, new Vector3(), new Vector3(0, 1, 0));
    const [right, up] = [0, 1].map((i) => new Vector3().setFromMatrixColumn(axes, i)) as [Vector3, Vector3];
    const half = Math.tan((FOV_DEG * Math.PI) / 360) / this.height;
    const tall = half * Math.max(0.2 * this.height, this.height - this.insets.top - this.insets.bottom);
    const wide = half * Math.max(0.2 * this.width, this.width - this.insets.left - this.insets.right);
    for (let round = 0; ; ++round) {
      const seen = places.map((place) => place.clone().sub(target)).map((p) => [p.dot(right), p.dot(up), p.dot(back)] as const);
      const distance = Math.max(...seen.map(([x, y, z]) => Math.max(Math.abs(x) / wide, Math.abs(y) / tall) + z));
      if (round === CENTERINGS) return { target, distance };
      // What is near takes more room: the middle of the picture is not that of the box.
      const middle = (axis: 0 | 1) => {
        const ends = seen.map((p) => p[axis] / (distance - p[2]));
        return 0.5 * distance * (Math.min(...ends) + Math.max(...ends));
      };
      target.addScaledVector(right, middle(0)).addScaledVector(up, middle(1));
    }
  }

  // What panels cover of the picture: its middle is that of the rest.
  inset(left: number, right: number, top: number, bottom: number): void {
    const before = Object.values(this.insets).join();
    this.insets = { left, right, top, bottom };
    this.center();
    if (Object.values(this.insets).join() !== before) this.onResize();
  }

  setDepth(radius: number): void {
    this.camera.near = radius / 300;
    this.camera.far = radius * 60;
    this.controls.minDistance = radius / 100;
    this.controls.maxDistance = radius * 20;
    this.camera.updateProjectionMatrix();
  }

  // Moves viewer and target together.
  shift(by: Vector3): void {
    this.camera.position.add(by);
    this.controls.target.add(by);
    if (this.glide) for (const place of [this.glide.to, this.glide.targetTo]) place.add(by);
    this.invalidate();
  }

  moveTo(position: Vector3, target: Vector3): void {
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.glide = { from: this.camera.position.clone(), to: position, targetFrom: this.controls.target.clone(), targetTo: target, began_ms: performance.now() - (still ? GLIDE_MS : 0) };
    this.invalidate();
  }

  resetLens(): void {
    this.camera.fov = FOV_DEG;
    this.camera.up.set(0, 1, 0);
    this.camera.updateProjectionMatrix();
    this.controls.enabled = true;
    this.invalidate();
  }

  private stepGlide(now_ms: number): void {
    if (!this.glide) return;
    const part = Math.min(1, (now_ms - this.glide.began_ms) / GLIDE_MS);
    const eased = 1 - (1 - part) ** 3;
    this.camera.position.lerpVectors(this.glide.from, this.glide.to, eased);
    this.controls.target.lerpVectors(this.glide.targetFrom, this.glide.targetTo, eased);
    this.camera.lookAt(this.controls.target);
    if (part >= 1) this.glide = undefined;
    this.invalidate();
  }

  private measure(now_ms: number): void {
    const took = now_ms - this.drawn_ms;
    this.drawn_ms = now_ms;
    if (took > STILL_MS) return;  // nothing was drawn in between
    this.times_ms.push(took);
    if (this.times_ms.length > 30) this.times_ms.shift();
    const mean = this.times_ms.reduce((sum, ms) => sum + ms, 0) / this.times_ms.length;
    this.frames_per_s = 1000 / mean;
    if (this.times_ms.length === 30 && mean > SLOW_MS && this.ratio > 0.75) this.setRatio(this.ratio * 0.8);
  }

  private setRatio(ratio: number): void {
    this.ratio = ratio;
    this.times_ms.length = 0;
    this.renderer.setPixelRatio(ratio);
    this.invalidate();
  }

  private center(): void {
    const { left, right, top, bottom } = this.insets;
    this.camera.setViewOffset(this.width, this.height, (right - left) / 2, (bottom - top) / 2, this.width, this.height);
    this.invalidate();
  }

  private resize(): void {
    this.width = Math.max(1, this.holder.clientWidth);
    this.height = Math.max(1, this.holder.clientHeight);
    this.renderer.setPixelRatio(this.ratio);
    this.renderer.setSize(this.width, this.height);
    this.camera.aspect = this.width / this.height;
    this.center();
    this.onResize();
  }
}
