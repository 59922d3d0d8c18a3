// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The colours of the scene. They stand in src/style/theme.css, so that page and scene agree.
import { Color } from "three";

export interface Palette {
  background: Color;
  fixed: Color;      // static points
  trial: Color;
  moving: Color;
  grid: Color;
  link: Color;
  accent: Color;
  lost: Color;
  relative: Color;
  gone: Color;
  cameras: Color[];
  ramp: [Color, Color, Color];  // of figures, low to high
}

export const CAMERA_COLOURS = 8;

export function readPalette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const colour = (name: string) => new Color(style.getPropertyValue(`--${name}`).trim());
  return {
    background: colour("background"),
    fixed: colour("static"),
    trial: colour("trial"),
    moving: colour("moving"),
    grid: colour("grid"),
    link: colour("link"),
    accent: colour("accent"),
    lost: colour("lost"),
    relative: colour("relative"),
    gone: colour("gone"),
    cameras: Array.from({ length: CAMERA_COLOURS }, (_, i) => colour(`camera-${i}`)),
    ramp: [colour("ramp-0"), colour("ramp-1"), colour("ramp-2")],
  };
}
