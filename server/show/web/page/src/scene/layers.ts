// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What is wanted in the picture.
import type { View } from "./view";

export const ALL_LAYERS = { "Static points": true, "Moving points": true, Objects: true, Trails: true, "Key frames": true, Links: true, Events: true, Floor: true, Names: true };

// moves: something does at this instant.
export function showLayers(view: View, moves: boolean): void {
  const layers = view.shownLayers;
  (view.soft?.object ?? view.points.object).visible = layers["Static points"];
  view.moving.root.visible = layers["Moving points"] && moves;
  for (const mark of view.objects.all.values()) {
    mark.body.visible = layers.Objects;
    mark.label.visible = layers.Objects && layers.Names && mark.label.visible;
    mark.trail.object.visible = layers.Trails;
  }
  for (const mark of view.cameras.values()) {
    mark.trail.object.visible = layers.Trails;
    mark.keyFrames.object.visible = layers["Key frames"] && mark.keyFrames.any;
    mark.label.visible &&= layers.Names;
  }
  view.fleet.links.strokes.object.visible = layers.Links && view.fleet.links.any;
  view.fleet.happened.strokes.object.visible = layers.Events && view.fleet.happened.any;
  view.floor.object.visible = layers.Floor;
}
