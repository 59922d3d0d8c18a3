// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The view goes along with a camera, or sees with its lens.
import { Matrix4, Vector3 } from "three";

import type { CameraMark } from "./scene/cameras";
import type { View } from "./scene/view";

const AWAY = 0.8;  // of the size of the map

export class Following {
  now: { name: string; through: boolean; last: Vector3 | undefined } | undefined;

  constructor(private readonly view: View) {}

  // A second time: no longer.
  follow(name: string, through: boolean): void {
    const again = this.now?.name === name && this.now.through === through;
    const wasThrough = this.now?.through === true;
    this.end();
    if (wasThrough && (again || !through)) this.view.fit();
    if (again) return;
    this.now = { name, through, last: undefined };
    this.view.fitting.release();
    this.view.stage.invalidate();
  }

  end(): void {
    if (this.now?.through) {
      this.view.stage.resetLens();
      this.view.cameras.get(this.now.name)?.tint(true);
    }
    this.now = undefined;
  }

  // Moves with the camera.
  keepUp(): void {
    const mark = this.now && this.view.cameras.get(this.now.name);
    if (!this.now || !mark?.pose) return;
    if (this.now.through) return this.lookThrough(mark);
    const at = new Vector3().setFromMatrixPosition(mark.body.matrixWorld);
    const { stage } = this.view;
    if (this.now.last) {
      if (!this.now.last.equals(at)) stage.shift(at.clone().sub(this.now.last));
    } else {
      const away = stage.camera.position.clone().sub(stage.controls.target).setLength(AWAY * this.view.radius);
      stage.moveTo(at.clone().add(away), at.clone());
    }
    this.now.last = at;
  }

  // As that camera sees it, with its lens.
  private lookThrough(mark: CameraMark): void {
    const { stage, radius } = this.view;
    const [, height = 3, , fy = 3] = mark.state?.fov ?? [];
    const turned = new Matrix4().multiplyMatrices(mark.body.matrixWorld, new Matrix4().makeRotationX(Math.PI));
    const { camera, controls } = stage;
    mark.tint(false);
    turned.decompose(camera.position, camera.quaternion, new Vector3());
    controls.enabled = false;
    controls.target.copy(camera.position).add(new Vector3(0, 0, -radius).applyQuaternion(camera.quaternion));
    const fov = (360 / Math.PI) * Math.atan(height / (2 * fy));
    if (Math.abs(camera.fov - fov) > 1e-3) {
      camera.fov = fov;
      camera.updateProjectionMatrix();
    }
    stage.invalidate();
  }
}
