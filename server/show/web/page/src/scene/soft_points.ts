// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The static points where a processor draws. A software WebGL takes about a microsecond for each point; putting them into
// a picture here and showing that picture, with its depth, is ten times as fast.
import { BufferAttribute, BufferGeometry, Color, DataTexture, FloatType, GLSL3, Matrix4, Mesh, NearestFilter, RawShaderMaterial, RedFormat, type PerspectiveCamera } from "three";

import type { Palette } from "./palette";
import { type ColourBy, rampColour } from "./point_shader";
import type { Points } from "./points";

const FOG_LEVELS = 16;
const FAR_AWAY = 1e30;
const MOST_PX = 5;

const VERTEX = `
uniform vec4 rect;  // left, bottom, right, top, in clip coordinates
in vec3 position;
void main() { gl_Position = vec4(mix(rect.xy, rect.zw, position.xy), 0.0, 1.0); }`;

const FRAGMENT = `
precision highp float;
uniform highp sampler2D picture, distances;
uniform float near, far;
out vec4 colour;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float distance = texelFetch(distances, at, 0).r;
  if (distance > 1e29) discard;
  colour = texelFetch(picture, at, 0);
  gl_FragDepth = 0.5 + 0.5 * ((far + near) / (far - near) - 2.0 * far * near / ((far - near) * distance));
}`;

export class SoftPoints {
  readonly object: Mesh;
  private readonly material: RawShaderMaterial;
  private width = 0;
  private height = 0;
  private colours = new Uint32Array(0);
  private distances = new Float32Array(0);
  private shade = new Uint8Array(0);       // of each point: a row of the table
  private readonly table = new Uint32Array(FOG_LEVELS * 256);
  private readonly rect = { left: 0, bottom: 0, right: 0, top: 0 };  // what was drawn
  private look = "";
  private shadeLook = "";

  constructor() {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0]), 3));
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT,
      uniforms: { picture: { value: null }, distances: { value: null }, near: { value: 1 }, far: { value: 2 }, rect: { value: [0, 0, 0, 0] } },
    });
    this.object = new Mesh(geometry, this.material);
    this.object.frustumCulled = false;
    this.object.renderOrder = -2;
  }

  paint(palette: Palette, by: ColourBy): void {
    const full = new Color();
    const mixed = new Color();
    for (let fog = 0; fog < FOG_LEVELS; ++fog) {
      const faded = 1 - 0.45 * (fog / (FOG_LEVELS - 1));
      for (let index = 0; index < 256; ++index) {
        const certain = (index & 127) / 127;
        if (by === "state") full.copy(index >= 128 ? palette.trial : palette.fixed);
        else rampColour(palette.ramp, index / 255, full);
        const light = by !== "state" ? 0.85 : index >= 128 ? 0.75 : 0.5 + 0.48 * certain;
        mixed.lerpColors(palette.background, full, light * faded);
        const hex = mixed.getHex();
        this.table[256 * fog + index] = 0xff000000 | ((hex & 0xff) << 16) | (hex & 0xff00) | (hex >> 16);
      }
    }
    this.look = "";
  }

  // Draws again where anything has changed.
  draw(points: Points, camera: PerspectiveCamera, width: number, height: number, by: ColourBy, radius: number): void {
    const shadeLook = `${by} ${points.version}`;
    if (shadeLook !== this.shadeLook) this.writeShade(points, by);
    this.shadeLook = shadeLook;
    const uniforms = points.material.uniforms;
    const clip = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const look = [width, height, uniforms["size"]!.value, uniforms["leastCertain"]!.value, shadeLook, ...clip.elements].join();
    if (look === this.look) return;
    this.look = look;
    this.resize(width, height);
    this.clear();
    this.splat(points, clip, camera.near, (uniforms["size"]!.value as number) * (uniforms["pixelScale"]!.value as number), radius);
    this.send(camera);
  }

  private writeShade({ count, look, position, floor, ceiling }: Points, by: ColourBy): void {
    if (this.shade.length < count) this.shade = new Uint8Array(look.length / 4);
    for (let i = 0, at = 0; i < count; ++i, at += 4) {
      let index = (look[at]! > 0 ? 128 : 0) + (look[at + 1]! >> 1);
      if (by === "certainty") index = look[at + 1]!;
      else if (by === "views") index = look[at + 2]!;
      else if (by === "height") index = Math.min(255, Math.max(0, (255 * (position[3 * i + 1]! - floor)) / Math.max(1e-6, ceiling - floor)));
      this.shade[i] = index;
    }
  }

  private splat({ count, position, look, material }: Points, clip: Matrix4, near: number, size: number, radius: number): void {
    const { width, height, colours, distances, shade, table } = this;
    const m = clip.elements;
    // Rows that give pixels, not -1..1, when divided by w.
    const [a0, a1, a2, a3] = [0, 4, 8, 12].map((c) => 0.5 * width * (m[c]! + m[c + 3]!)) as [number, number, number, number];
    const [b0, b1, b2, b3] = [0, 4, 8, 12].map((c) => 0.5 * height * (m[c + 1]! + m[c + 3]!)) as [number, number, number, number];
    const [w0, w1, w2, w3] = [m[3]!, m[7]!, m[11]!, m[15]!];
    const least = 255 * (material.uniforms["leastCertain"]!.value as number);
    const fogScale = FOG_LEVELS / (3.4 * radius);
    const fogFrom = 1.6 * radius;
    const smallest = Math.round(material.uniforms["smallest"]!.value as number);
    let [left, right, bottom, top] = [width, 0, height, 0];
    for (let i = 0, at = 0; i < count; ++i, at += 3) {
      const x = position[at]!;
      const y = position[at + 1]!;
      const z = position[at + 2]!;
      const w = w0 * x + w1 * y + w2 * z + w3;
      const certain = look[4 * i + 1]!;
      if (w < near || certain < least) continue;
      const inverse = 1 / w;
      let grain = (size * (0.7 + 0.00216 * certain) * inverse + 0.5) | 0;
      grain = grain < smallest ? smallest : grain > MOST_PX ? MOST_PX : grain;
      const u = ((a0 * x + a1 * y + a2 * z + a3) * inverse - 0.5 * grain + 0.5) | 0;
      const v = ((b0 * x + b1 * y + b2 * z + b3) * inverse - 0.5 * grain + 0.5) | 0;
      if (u < 1 || v < 1 || u + grain >= width || v + grain >= height) continue;
      const fog = ((w - fogFrom) * fogScale) | 0;
      const colour = table[256 * (fog < 0 ? 0 : fog > FOG_LEVELS - 1 ? FOG_LEVELS - 1 : fog) + shade[i]!]!;
      if (u < left) left = u;
      if (u > right) right = u;
      if (v < bottom) bottom = v;
      if (v > top) top = v;
      for (let row = v * width + u, end = row + grain * width; row < end; row += width) {
        for (let pixel = row; pixel < row + grain; ++pixel) {
          if (w >= distances[pixel]!) continue;
          distances[pixel] = w;
          colours[pixel] = colour;
        }
      }
    }
    Object.assign(this.rect, { left, bottom, right: Math.min(width, right + MOST_PX), top: Math.min(height, top + MOST_PX) });
  }

  private clear(): void {
    const { bottom, top } = this.rect;
    if (top > bottom) this.distances.fill(FAR_AWAY, bottom * this.width, top * this.width);
  }

  private send(camera: PerspectiveCamera): void {
    const { uniforms } = this.material;
    const { left, bottom, right, top } = this.rect;
    this.object.visible = right > left && top > bottom;
    uniforms["rect"]!.value = [(2 * left) / this.width - 1, (2 * bottom) / this.height - 1, (2 * right) / this.width - 1, (2 * top) / this.height - 1];
    uniforms["near"]!.value = camera.near;
    uniforms["far"]!.value = camera.far;
    (uniforms["picture"]!.value as DataTexture).needsUpdate = true;
    (uniforms["distances"]!.value as DataTexture).needsUpdate = true;
  }

  private resize(width: number, height: number): void {
    if (width === this.width && height === this.height) return;
    [this.width, this.height] = [width, height];
    this.colours = new Uint32Array(width * height);
    this.distances = new Float32Array(width * height).fill(FAR_AWAY);
    const { uniforms } = this.material;
    for (const name of ["picture", "distances"]) (uniforms[name]!.value as DataTexture | null)?.dispose();
    const picture = new DataTexture(new Uint8Array(this.colours.buffer), width, height);
    const distances = new DataTexture(this.distances, width, height, RedFormat, FloatType);
    for (const texture of [picture, distances]) texture.minFilter = texture.magFilter = NearestFilter;
    uniforms["picture"]!.value = picture;
    uniforms["distances"]!.value = distances;
  }
}
