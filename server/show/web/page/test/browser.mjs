// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A browser with the page of a made-up run.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

import { startMock } from "../dev/mock.mjs";
import { CHROMIUM } from "./chromium.mjs";

const PATIENCE_MS = 60000;
const root = join(dirname(fileURLToPath(import.meta.url)), "..", "dist");

export class Visit {
  errors = [];

  static async begin({ query = "", size = [1280, 720], touch = false, ...mock } = {}) {
    const { chromium } = await import("playwright-core");
    const visit = new Visit();
    visit.options = { root, ...mock };
    visit.mock = await startMock(visit.options);
    visit.browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
    visit.page = await visit.browser.newPage({ viewport: { width: size[0], height: size[1] }, hasTouch: touch, reducedMotion: "reduce", colorScheme: "dark" });
    visit.page.setDefaultTimeout(PATIENCE_MS);
    visit.page.on("console", (message) => { if (message.type() === "error") visit.errors.push(message.text()); });
    visit.page.on("pageerror", (error) => visit.errors.push(error.stack));
    visit.blank = await visit.browser.newPage();
    await visit.page.goto(`http://127.0.0.1:${visit.mock.port}/${query}`);
    return visit;
  }

  stop() { return this.mock.stop(); }

  // The server again, where it was; `changes` to its options.
  async restart(changes = {}) {
    this.mock = await startMock({ ...this.options, port: this.mock.port, ...changes });
  }

  async end() {
    await this.browser.close();
    await this.mock.stop().catch(() => {});
  }

  text(selector) { return this.page.textContent(selector); }

  // Until what `selector` says matches.
  async says(selector, pattern) {
    await this.page.waitForFunction(([where, source]) => {
      const element = document.querySelector(where);
      return element !== null && new RegExp(source).test(element.textContent);
    }, [selector, pattern.source]);
    return this.text(selector);
  }

  // What axe-core finds of serious faults for people who see, hear or move otherwise.
  async faults() {
    await this.page.evaluate(await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8"));
    const { violations } = await this.page.evaluate(() => window.axe.run(document, { resultTypes: ["violations"] }));
    const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
    return serious.map(({ id, nodes }) => `${id}: ${nodes.map(({ target, any }) => `${target} ${any[0]?.message ?? ""}`).join("; ")}`);
  }

  // What is downloaded by doing so.
  async saved(act) {
    const download = this.page.waitForEvent("download");
    await act();
    const file = await download;
    return { name: file.suggestedFilename(), octets: await readFile(await file.path()) };
  }

  // What was done is in the picture two frames later.
  frames() {
    return this.page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  }

  // Asks once a picture; a machine that draws slowly has as many seconds as one that draws fast.
  async until(holds, what = `${holds}`) {
    for (const end = Date.now() + PATIENCE_MS;;) {
      const found = await holds();
      if (found) return found;
      if (Date.now() > end) throw new Error(`never came: ${what}`);
      await this.frames();
    }
  }

  // How many pixels of the picture are of a kind, and where some of them are.
  async pixels(kind) {
    const png = (await this.page.screenshot()).toString("base64");
    return this.blank.evaluate(async ([data, wanted]) => {
      const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0);
      const { data: rgba } = context.getImageData(0, 0, image.width, image.height);
      const is = {
        point: (r, g, b) => r > 105 && b >= r && b - r < 60 && g > 105,
        moving: (r, g, b) => r > 200 && g > 110 && g < 190 && b < 120,
      }[wanted];
      const found = { count: 0, some: [] };
      for (let y = 60; y < image.height - 110; ++y) {
        for (let x = 290; x < image.width - 10; ++x) {
          const at = 4 * (y * image.width + x);
          if (!is(rgba[at], rgba[at + 1], rgba[at + 2])) continue;
          if (found.count++ % 40 === 0) found.some.push([x, y]);
        }
      }
      return found;
    }, [png, kind]);
  }

  pixelsUntil(kind, enough) {
    const look = async () => {
      const found = await this.pixels(kind);
      return enough(found.count) && found;
    };
    return this.until(look, `pixels of ${kind}, ${enough}`);
  }
}
