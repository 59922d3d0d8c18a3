// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node test/picture.mjs URL FILE.png [--wait S] [--size WxH] [--theme light] [--keys ft] [--film N]: what a browser shows
// of a server. The wait is for points, at most two minutes, and then S seconds; the keys are pressed before the last of them.
// A film is of a recorded run (URL?recorded): N pictures, FILE_000.png and so on, evenly from its begin to its end. ImageMagick
// makes a moving picture of them: convert -delay 12 FILE_*.png -layers optimize FILE.gif
import { parseArgs } from "node:util";
import { chromium } from "playwright-core";

import { CHROMIUM } from "./chromium.mjs";

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    wait: { type: "string", default: "5" },
    size: { type: "string", default: "1280x720" },
    theme: { type: "string", default: "dark" },
    keys: { type: "string", default: "" },
    film: { type: "string", default: "0" },
  },
});
const [url, file] = positionals;
const [width, height] = values.size.split("x").map(Number);
const browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
const page = await browser.newPage({ viewport: { width, height }, colorScheme: values.theme });
page.on("console", (message) => { if (message.type() === "error") console.log(message.text()); });
page.on("pageerror", (error) => console.log(error.stack));
await page.goto(url);
await page.waitForFunction(() => /[1-9]/.test(document.querySelector('.figures [data-key="points"] dd')?.textContent ?? ""), { timeout: 120000 });
await page.waitForTimeout(1000 * Math.max(0, Number(values.wait) - 1));
for (const key of values.keys) await page.keyboard.press(key);
await page.waitForTimeout(1000);
await page.screenshot({ path: file });
const films = Number(values.film);
for (let i = 1; i <= films; ++i) {
  const box = await page.locator(".track").boundingBox();
  await page.mouse.click(box.x + 62 + (i / films) * (box.width - 74), box.y + 30);
  await page.mouse.move(width - 1, 1);
  await page.waitForTimeout(500);
  await page.screenshot({ path: file.replace(/\.png$/, `_${String(i).padStart(3, "0")}.png`) });
}
console.log(`${await page.textContent(".pill")}: ${await page.textContent(".figures")}`);
await browser.close();
