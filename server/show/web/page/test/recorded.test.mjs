// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { recordingOf } from "../dev/record.mjs";
import { Visit } from "./browser.mjs";

let recording;
let visit;

before(async () => {
  recording = await recordingOf({ seconds_s: 24, points: 4000 });
  visit = await Visit.begin({ recording, query: "?recorded&points=gpu" });
});
after(() => visit.end());

const points = async () => Number((await visit.text('.figures [data-key="points"] dd')).replaceAll(",", ""));
const at = async (part) => {
  const box = await visit.page.locator(".track").boundingBox();
  await visit.page.mouse.click(box.x + 62 + part * (box.width - 74), box.y + 30);
};

test("a recorded run is shown from its end", async () => {
  await visit.says(".pill", /recorded run/);
  await visit.says(".time", /0:24/);
  await visit.says(".figures", /points/);
  await visit.pixelsUntil("point", (count) => count > 800);
  await visit.says(".agent[data-agent=cam1] .state", /lost for/);
});

test("any instant of it can be gone to", async () => {
  const end = await points();
  await at(0.2);
  await visit.says(".time", /0:04/);
  await visit.page.waitForFunction((most) => {
    const shown = document.querySelector('.figures [data-key="points"] dd');
    return Number(shown.textContent.replaceAll(",", "")) < most;
  }, 0.8 * end);
  await visit.says('.figures [data-key="maps"]', /2maps/);
});

test("it is played", async () => {
  await visit.page.keyboard.press(" ");
  await visit.says(".time", /0:06/);
  await visit.page.keyboard.press(" ");
});

test("a file is taken, also one that was cut off", async () => {
  const take = (name, buffer) => visit.page.setInputFiles("input[type=file]", { name, buffer, mimeType: "application/octet-stream" });
  await take("cut.mcap", recording.subarray(0, Math.floor(0.6 * recording.length)));
  await visit.says(".pill", /cut\.mcap/);
  await visit.pixelsUntil("point", (count) => count > 300);
  await take("whole.mcap", recording);
  await visit.says(".pill", /whole\.mcap/);
  await visit.says(".time", /0:24/);
  await take("notes.mcap", Buffer.from("nothing of the kind"));
  await visit.says(".news", /notes\.mcap cannot be shown: it is no MCAP file/);
  await visit.says(".pill", /whole\.mcap/);
});

test("the console has no error", () => assert.deepEqual(visit.errors.filter((text) => !/\/ws' failed|ERR_/.test(text)), []));
