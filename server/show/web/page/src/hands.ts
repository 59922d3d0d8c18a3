// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Pointer and keys.
export interface Hands {
  // At a place of the picture; more: with what is picked already.
  pick(x_px: number, y_px: number, finger: boolean, more: boolean): void;
  down(): void;
  // False: the key means nothing.
  key(key: string): boolean;
}

const CLICK_PX = 6;

export function listenToHands(canvas: HTMLElement, hands: Hands): void {
  let down: { x: number; y: number } | undefined;
  canvas.addEventListener("pointerdown", (event) => {
    hands.down();
    down = { x: event.clientX, y: event.clientY };
  });
  canvas.addEventListener("pointerup", (event) => {
    if (!down || Math.hypot(event.clientX - down.x, event.clientY - down.y) > CLICK_PX || event.button !== 0) return;
    const { left, top } = canvas.getBoundingClientRect();
    hands.pick(event.clientX - left, event.clientY - top, event.pointerType === "touch", event.shiftKey);
  });
  window.addEventListener("keydown", (event) => {
    const isControl = event.target instanceof HTMLButtonElement || event.target instanceof HTMLInputElement;
    if ((isControl && event.key === " ") || event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    if (hands.key(event.key.toLowerCase())) event.preventDefault();
  });
}
