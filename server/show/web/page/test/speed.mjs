// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node test/speed.mjs [POINTS]: pictures a second while the view is turned by hand and the run goes on.
import { Visit } from "./browser.mjs";

const points = Number(process.argv[2] ?? 200000);
const visit = await Visit.begin({ points, whole: true });
const { page } = visit;
await visit.says('.figures [data-key="points"]', /\d/);
await visit.pixelsUntil("point", (count) => count > 5000);

const measured = page.evaluate(() => new Promise((done) => {
  const times = [];
  const begin = performance.now();
  const step = () => {
    times.push(performance.now());
    if (times.at(-1) - begin < 8000) return requestAnimationFrame(step);
    const gaps = times.slice(1).map((time, i) => time - times[i]).sort((a, b) => a - b);
    return done({ rate: times.length / 8, median_ms: gaps[gaps.length >> 1], p95_ms: gaps[Math.floor(0.95 * gaps.length)] });
  };
  requestAnimationFrame(step);
}));
let going = true;
void measured.finally(() => { going = false; });
await page.mouse.move(700, 400);
await page.mouse.down();
for (let x = 0; going; x += 4) await page.mouse.move(700 + 200 * Math.sin(x / 80), 400 + 30 * Math.sin(x / 50));
await page.mouse.up();
const { rate, median_ms, p95_ms } = await measured;
console.log(`${points} points, 1280x720: ${rate.toFixed(1)} pictures a second, median ${median_ms.toFixed(0)} ms, p95 ${p95_ms.toFixed(0)} ms`);
await visit.end();
