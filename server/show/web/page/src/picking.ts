// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is picked, what is said of it, and the length between two picked things.
import { describe } from "./describe";
import { distanceOf, placeOf } from "./scene/measure";
import type { Picked } from "./scene/pick";
import type { View } from "./scene/view";
import { length } from "./ui/dom";
import type { Inspector } from "./ui/inspector";

const UNKNOWN = [0, 0, 0, 0, 0, 0];

export class Picking {
  first: Picked | undefined;
  private second: Picked | undefined;
  private measures = false;          // the next thing is the other end of a length
  private told: number[] | undefined;  // covariance of the first, by the server

  constructor(private readonly view: View, private readonly inspector: Inspector, private readonly canvas: HTMLElement) {
    inspector.onClose = () => this.pick(undefined);
    inspector.onLife = ({ covariance }) => { this.told = covariance; };
    inspector.onMeasure = () => this.measure();
  }

  pick(picked: Picked | undefined, more = false): void {
    if (this.first && picked && (more || this.measures)) {
      this.second = picked;
    } else {
      this.first = picked;
      this.second = this.told = undefined;
    }
    this.setMeasures(false);
  }

  // The next click is the other end.
  measure(): void { if (this.first) this.setMeasures(!this.measures); }

  // One step back; false: nothing is picked.
  letGo(): boolean {
    if (!this.first) return false;
    if (this.measures) this.setMeasures(false);
    else if (this.second) this.second = undefined;
    else this.pick(undefined);
    return true;
  }

  show(served: boolean): void {
    const { view, first } = this;
    const shown = first && describe(view, first, this.told);
    if (shown) shown.figures.push(...this.length());
    else view.ruler.hide();
    this.inspector.show(shown, served, this.measures);
    const place = first && placeOf(view, first);
    if (!place) view.selection.hide();
    else view.selection.show(view.frames.of(place.frame).group, place.position, this.told ?? place.covariance ?? UNKNOWN);
    view.stage.invalidate();
  }

  private setMeasures(measures: boolean): void {
    this.measures = measures;
    this.canvas.classList.toggle("measures", measures);
    this.view.stage.invalidate();
  }

  private length(): [string, string][] {
    const { view, first, second } = this;
    const [a, b] = [first, second].map((picked) => picked && placeOf(view, picked));
    if (!second || !a || !b) {
      view.ruler.hide();
      return second ? [[`To ${nameOf(second)}`, "not seen now"]] : [];
    }
    if (a.frame !== b.frame) {
      view.ruler.hide();
      return [[`To ${nameOf(second)}`, "in another map"]];
    }
    const unit = view.unitOf(a.frame);
    const measured = distanceOf(a, b);
    const text = `${length(measured.length, unit)}${measured.sigma === undefined ? "" : ` ± ${length(measured.sigma, unit)}`}`;
    view.ruler.show(view, a, b, text);
    return [[`To ${nameOf(second)}`, text]];
  }
}

function nameOf(picked: Picked): string {
  if (picked.kind === "camera") return picked.name;
  return picked.kind === "track" ? `track ${picked.agent}/${picked.id}` : `${picked.kind === "moving" ? "moving point" : picked.kind} ${picked.id}`;
}
