// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// From where the scene is looked at: all of it, until somebody chooses another view.
import { Box3, Vector3 } from "three";

import { floorOf } from "./frames";
import type { View } from "./view";

const ENOUGH_POINTS = 50;   // to fit the view to
const FIT_POINTS = 1500;
const REFIT = 0.12;         // of the size of the map: it has grown by so much
const BETTER = 0.88;        // of the distance: another side is looked at for so much
const FIRST_VIEWS = [[0.34, 0.95], [0.34 - Math.PI / 2, 0.95], [0.34, 0.6], [0.34 - Math.PI / 2, 0.6]]
  .map(([azimuth, polar]) => new Vector3().setFromSphericalCoords(1, polar!, azimuth!));
const ABOVE = new Vector3().setFromSphericalCoords(1, 0.0005, 0);  // the grid along the edges of the picture

export class Fitting {
  above = false;
  private fits = true;      // the view is nobody's choice
  private ours = true;      // nor is the side that it is looked at from
  private readonly fitted = new Box3();

  constructor(private readonly view: View) {
    view.stage.onResize = () => this.again();
  }

  clear(): void {
    this.fits = this.ours = true;
    this.above = false;
    this.fitted.makeEmpty();
  }

  // From now on the view is somebody's choice.
  release(): void { this.fits = this.ours = this.above = false; }

  // All of it, from where the viewer stands; at first from the side that shows it largest.
  fit(): void {
    this.fits = true;
    this.look();
  }

  // All is kept in sight until somebody chooses another view.
  keep(): void {
    const box = this.view.frames.extent();
    if (!this.fits || this.view.points.count < ENOUGH_POINTS || box.isEmpty()) return;
    const moved = this.fitted.min.distanceTo(box.min) + this.fitted.max.distanceTo(box.max);
    if (!this.fitted.isEmpty() && moved < REFIT * box.getSize(new Vector3()).length()) return;
    this.look();
  }

  // From above, or back.
  flip(): void {
    if (this.above) return this.side();
    this.above = this.fits = this.ours = true;
    this.look();
  }

  side(): void {
    this.above = false;
    this.fits = this.ours = true;
    this.look();
  }

  // The picture has another size.
  private again(): void { if (this.fits && !this.fitted.isEmpty()) this.look(); }

  private look(): void {
    this.fitted.copy(this.view.frames.extent());
    this.view.stage.fit(this.places(), this.above ? ABOVE : this.ours ? this.bestSide() : undefined);
  }

  private bestSide(): Vector3 {
    const places = this.places();
    if (places.length === 0) return FIRST_VIEWS[0]!;
    const far = FIRST_VIEWS.map((side) => this.view.stage.plan(places, side).distance);
    const best = far.indexOf(Math.min(...far));
    return FIRST_VIEWS[far[best]! < BETTER * far[0]! ? best : 0]!;
  }

  // Some of all that is shown, without what lies far out.
  private places(): Vector3[] {
    const { frames, cameras, points } = this.view;
    const box = frames.extent();
    const out: Vector3[] = [];
    for (const mark of cameras.values()) {
      const { parent } = mark.body;
      if (!parent || !mark.body.visible || !parent.visible) continue;
      const places = mark.places();
      out.push(...places.filter((_, i) => i % 8 === 0 || i === places.length - 1).map((place) => place.applyMatrix4(parent.matrixWorld)));
    }
    if (frames.shown().length > 1) for (const frame of frames.shown()) out.push(...floorOf(frame));
    const stride = Math.max(1, Math.floor(points.count / FIT_POINTS));
    for (let i = 0; i < points.count; i += stride) {
      const place = points.placeOf(i);
      if (box.containsPoint(place)) out.push(place);
    }
    return out;
  }
}
