// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What a camera sees, once a second while somebody wants it. No image leaves a robot before.
import { button, make, setText } from "./dom";

const PERIOD_MS = 1000;
const PATIENCE_MS = 4000;

export class Thumbnail {
  readonly switch: HTMLButtonElement;
  readonly element: HTMLElement;
  private readonly image = make("img", { hidden: "" });
  private readonly said = make("figcaption", { "aria-live": "polite" });
  private timer = 0;
  private since_ms = 0;  // without an image

  constructor(private readonly agent: string, private readonly token: string | null) {
    this.switch = button("image", `Image of what ${agent} sees`, () => this.set(this.timer === 0), "Image");
    this.switch.setAttribute("aria-pressed", "false");
    this.image.alt = `What ${agent} sees`;
    this.element = make("figure", { class: "thumbnail", hidden: "" }, this.image, this.said);
  }

  // Nothing is asked for while the card is closed or the agent is not heard live.
  allow(live: boolean): void {
    this.switch.hidden = !live;
    if (!live) this.set(false);
  }

  set(on: boolean): void {
    if (on === (this.timer !== 0)) return;
    this.element.hidden = !on;
    this.switch.setAttribute("aria-pressed", String(on));
    window.clearInterval(this.timer);
    this.timer = 0;
    if (!on) return this.show(undefined);
    this.since_ms = performance.now();
    this.timer = window.setInterval(() => void this.ask(), PERIOD_MS);
    setText(this.said, `${this.agent} is asked for an image.`);
    void this.ask();
  }

  private async ask(): Promise<void> {
    if (document.hidden) return;
    const query = new URLSearchParams({ agent: this.agent, ...(this.token === null ? {} : { token: this.token }) });
    try {
      const response = await fetch(`api/v1/thumbnail?${query.toString()}`);
      if (this.timer === 0) return;
      if (response.status === 200) return this.show(await response.blob());
      const sentence = (await response.text()).trim();
      if (response.status !== 202 || performance.now() - this.since_ms > PATIENCE_MS) this.say(sentence);
    } catch {
      this.say("The server does not answer.");
    }
  }

  private say(sentence: string): void {
    this.show(undefined);
    setText(this.said, sentence);
  }

  private show(jpeg: Blob | undefined): void {
    URL.revokeObjectURL(this.image.src);
    this.image.hidden = !jpeg;
    if (!jpeg) return this.image.removeAttribute("src");
    this.image.src = URL.createObjectURL(jpeg);
    this.since_ms = performance.now();
    setText(this.said, "");
  }
}
