// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Points: size and light by how certain they are, colour by what is asked for. Nothing is blended: fading is towards the
// background, so that the order of the points does not matter and a processor can draw them too.
import { Color, ShaderMaterial } from "three";

export const COLOUR_BY = ["state", "certainty", "height", "views"] as const;
export type ColourBy = (typeof COLOUR_BY)[number];

export function rampColour(ramp: readonly [Color, Color, Color], t: number, into: Color): Color {
  return t < 0.5 ? into.lerpColors(ramp[0], ramp[1], 2 * t) : into.lerpColors(ramp[1], ramp[2], 2 * t - 1);
}

const VERTEX = `
attribute vec4 look;  // state, certainty, views, new: each 0..1
uniform float size, smallest, pixelScale, radius, fresh, leastCertain, floorHeight, ceilingHeight;
uniform int colourBy;
uniform vec3 background, fixedColour, trialColour, freshColour, rampLow, rampMiddle, rampHigh;
varying vec3 colour;

vec3 ramp(float t) {
  return t < 0.5 ? mix(rampLow, rampMiddle, 2.0 * t) : mix(rampMiddle, rampHigh, 2.0 * t - 1.0);
}

void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * seen;
  bool onTrial = look.x > 0.001;
  float certain = look.y;
  if (certain < leastCertain) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  float height = clamp((position.y - floorHeight) / max(1e-6, ceilingHeight - floorHeight), 0.0, 1.0);
  vec3 full = onTrial ? trialColour : fixedColour;
  if (colourBy == 1) full = ramp(certain);
  if (colourBy == 2) full = ramp(height);
  if (colourBy == 3) full = ramp(look.z);
  float light = onTrial ? 0.75 : mix(0.5, 1.0, certain);
  if (colourBy == 0) light *= mix(0.78, 1.08, height);
  float depth = -seen.z / radius;
  light *= mix(1.0, 0.55, smoothstep(1.6, 5.0, depth));
  colour = mix(background, full, min(light, 1.0));
  colour = mix(colour, freshColour, look.w * fresh);
  float grown = onTrial ? 0.8 : mix(0.7, 1.25, certain);
  gl_PointSize = clamp(size * grown * pixelScale / max(0.001, -seen.z), smallest, 12.0 * smallest);
}`;

const FRAGMENT = `
varying vec3 colour;
void main() {
  gl_FragColor = vec4(colour, 1.0);
  #include <colorspace_fragment>
}`;

export function pointMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: {
      size: { value: 0.02 },
      smallest: { value: 1.5 },
      pixelScale: { value: 800 },
      radius: { value: 1 },
      fresh: { value: 0 },
      leastCertain: { value: 0 },
      floorHeight: { value: 0 },
      ceilingHeight: { value: 1 },
      colourBy: { value: 0 },
      background: { value: new Color() },
      fixedColour: { value: new Color() },
      trialColour: { value: new Color() },
      freshColour: { value: new Color() },
      rampLow: { value: new Color() },
      rampMiddle: { value: new Color() },
      rampHigh: { value: new Color() },
    },
  });
}
