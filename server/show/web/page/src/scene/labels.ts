// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Names in the picture, as elements over it.
import { Vector3 } from "three";

import type { Stage } from "./stage";

interface Box { x: number; y: number; width: number }

const LINE_PX = 19;

export class Label {
  readonly element = document.createElement("div");
  readonly place = new Vector3();
  visible = true;
  private width = 0;

  constructor(className: string) { this.element.className = `label ${className}`; }

  text(name: string, detail = ""): void {
    const wanted = detail === "" ? name : `${name}\n${detail}`;
    if (this.element.dataset["text"] === wanted) return;
    this.element.dataset["text"] = wanted;
    const small = document.createElement("small");
    small.textContent = detail;
    this.element.replaceChildren(name, ...(detail === "" ? [] : [small]));
    this.width = 0;
  }

  // Upwards, until it covers no other name. Rings stay where they are.
  clear(x: number, y: number, taken: Box[]): number {
    if (this.element.childNodes.length === 0) return y;
    if (this.width === 0) this.width = this.element.offsetWidth;
    const hit = (box: Box) => Math.abs(box.x - x) < 0.5 * (box.width + this.width) + 4 && Math.abs(box.y - y) < LINE_PX;
    for (let tries = 0; tries < 6 && taken.some(hit); ++tries) y = Math.min(...taken.filter(hit).map((box) => box.y)) - LINE_PX;
    taken.push({ x, y, width: this.width });
    return y;
  }
}

export class Labels {
  private readonly all = new Set<Label>();
  private readonly seen = new Vector3();

  constructor(private readonly holder: HTMLElement) {}

  add(label: Label): Label {
    this.all.add(label);
    this.holder.append(label.element);
    return label;
  }

  remove(label: Label): void {
    this.all.delete(label);
    label.element.remove();
  }

  // Those that are shown, for a picture.
  texts(): { text: string; x: number; y: number; width: number; colour: string; background: string }[] {
    const holder = this.holder.getBoundingClientRect();
    return [...this.all].filter(({ element }) => !element.hidden && element.textContent !== "").map(({ element }) => {
      const { left, top, width, height } = element.getBoundingClientRect();
      const { color, backgroundColor, paddingLeft } = getComputedStyle(element);
      const [name, detail] = (element.dataset["text"] ?? "").split("\n");
      const indent = parseFloat(paddingLeft);
      return { text: [name, detail].filter(Boolean).join("  "), x: left - holder.left + indent, y: top - holder.top + height / 2, width: width - 2 * indent, colour: color, background: backgroundColor };
    });
  }

  place(stage: Stage): void {
    const taken: Box[] = [];
    for (const label of this.all) {
      const p = this.seen.copy(label.place).project(stage.camera);
      const shown = label.visible && p.z < 1 && Math.abs(p.x) < 1.1 && Math.abs(p.y) < 1.1;
      label.element.hidden = !shown;
      if (!shown) continue;
      const x = ((p.x + 1) / 2) * stage.width;
      const y = label.clear(x, ((1 - p.y) / 2) * stage.height, taken);
      label.element.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
    }
  }
}
