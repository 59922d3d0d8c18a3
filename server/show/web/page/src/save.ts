// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is shown, as files: a picture with names, the map as PLY.
import type { PointFigures } from "./scene/points";
import type { View } from "./scene/view";

const CAPTION_PX = 22;

export function download(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// As it stands on the screen, with a line below that says of what.
export async function pictureOf(view: View, caption: string): Promise<Blob> {
  view.stage.drawNow();
  const drawn = view.stage.renderer.domElement;
  const ratio = drawn.width / drawn.clientWidth;
  const canvas = document.createElement("canvas");
  canvas.width = drawn.width;
  canvas.height = drawn.height + CAPTION_PX * ratio;
  const context = canvas.getContext("2d")!;
  context.fillStyle = `#${view.palette.background.getHexString()}`;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(drawn, 0, 0);
  context.scale(ratio, ratio);
  const style = getComputedStyle(document.body);
  context.textBaseline = "middle";
  for (const { text, x, y, width, colour, background } of view.labels.texts()) {
    context.font = `600 12px ${style.fontFamily}`;
    context.fillStyle = background;
    context.fillRect(x - 6, y - 9, Math.max(width, context.measureText(text).width) + 12, 18);
    context.fillStyle = colour;
    context.fillText(text, x, y);
  }
  context.font = `12px ${style.fontFamily}`;
  context.fillStyle = style.color;
  context.fillText(caption, 10, drawn.height / ratio + CAPTION_PX / 2);
  return new Promise((done, fail) => canvas.toBlob((blob) => (blob ? done(blob) : fail(new Error("no picture could be made"))), "image/png"));
}

// The columns of /api/v1/map.ply; unit: that of the lengths.
export function plyOf(points: Iterable<PointFigures>, unit: string): Uint8Array<ArrayBuffer> {
  const all = [...points];
  const head = new TextEncoder().encode(["ply", "format binary_little_endian 1.0", `comment lengths in ${unit === "m" ? "metres" : "units of the map, the scale is not known"}`,
    `element vertex ${all.length}`, ...["x", "y", "z", "sqrt_trace_sigma"].map((name) => `property float ${name}`), "property uint id", "end_header", ""].join("\n"));
  const out = new Uint8Array(head.length + 20 * all.length);
  out.set(head);
  const view = new DataView(out.buffer);
  all.forEach(({ position, sigma, id }, i) => {
    const at = head.length + 20 * i;
    [...position, sigma].forEach((value, k) => view.setFloat32(at + 4 * k, value, true));
    view.setUint32(at + 16, id, true);
  });
  return out;
}
