// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording that is dropped on the page, or chosen.
import { make } from "./dom";

export function acceptFiles(take: (file: File) => void): { choose(): void; hint: HTMLElement } {
  const input = make("input", { type: "file", accept: ".mcap", hidden: "", "aria-label": "recording" });
  const hint = make("div", { class: "drop", hidden: "" }, "Drop the recording to see it");
  input.addEventListener("change", () => {
    if (input.files?.[0]) take(input.files[0]);
    input.value = "";
  });
  document.body.append(input);
  document.addEventListener("dragover", (event) => {
    event.preventDefault();
    hint.hidden = false;
  });
  document.addEventListener("dragleave", (event) => { if (event.relatedTarget === null) hint.hidden = true; });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    hint.hidden = true;
    const file = event.dataTransfer?.files[0];
    if (file) take(file);
  });
  return { choose: () => input.click(), hint };
}
