// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// How the page stands at each end of a run, and on each screen.
import assert from "node:assert/strict";
import { test } from "node:test";

import { Visit } from "./browser.mjs";

// A visit for one test.
const visiting = (options, act) => async () => {
  const visit = await Visit.begin(options);
  try {
    await act(visit);
  } finally {
    await visit.end();
  }
};
const inside = async (visit, selector) => {
  const box = await visit.page.locator(selector).boundingBox();
  const { width, height } = visit.page.viewportSize();
  assert.ok(box && box.x >= 0 && box.y >= 0 && box.x + box.width <= width && box.y + box.height <= height, `${selector}: ${JSON.stringify(box)}`);
};

test("a server without agents waits for them, and says how one comes", visiting({ cameras: [] }, async (visit) => {
  await visit.says(".notice", /Waiting for agents.*coslam-agent --domain 7 --id/);
  assert.deepEqual(await visit.faults(), []);
}));

test("a token is asked for", visiting({ token: "secret" }, async (visit) => {
  await visit.says(".notice", /wants a token.*\?token=/);
  assert.deepEqual(await visit.faults(), []);
  await visit.page.goto(`${visit.page.url()}?token=secret`);
  await visit.says(".pill", /^live/);
}));

test("a run that ends is over, and nobody is lost", visiting({ start_s: 50 }, async (visit) => {
  await visit.says(".figures", /points/);
  visit.mock.program.finish();
  await visit.says(".pill", /being adjusted/);
  await visit.mock.end();
  await visit.says(".notice", /The run is over.*coslam view result/);
  for (const name of ["cam0", "cam1", "cam2"]) await visit.says(`.agent[data-agent=${name}] .state`, /ended/);
  assert.equal(await visit.page.locator(".label.lost:visible").count(), 0);
  assert.equal(await visit.page.locator(".go-live:visible").count(), 0);
  assert.deepEqual(await visit.faults(), []);
  await visit.restart({ start_s: 16, run: "77777777" });
  await visit.says(".run", /77777777/);
  await visit.page.locator(".notice").waitFor({ state: "hidden" });
}));

test("a map of another unit stands beside, framed and named", visiting({ start_s: 2 }, async (visit) => {
  await visit.page.waitForFunction(() => [...document.querySelectorAll(".label.border")].some((label) => /map 2.*own unit/.test(label.textContent) && !label.hidden));
}));

for (const theme of ["dark", "light"]) {
  test(`axe finds nothing serious, ${theme}`, visiting({ start_s: 50, query: `?theme=${theme}` }, async (visit) => {
    await visit.says(".figures", /points/);
    await visit.page.click(".agent[data-agent=cam0] .head");
    visit.mock.program.lose("cam1");
    await visit.says(".agent[data-agent=cam1] .state", /lost for/);
    assert.deepEqual(await visit.faults(), []);
    await visit.page.getByLabel("What is shown, and in which colours").click();
    assert.deepEqual(await visit.faults(), []);
    await visit.page.keyboard.press("?");
    assert.deepEqual(await visit.faults(), []);
    await visit.page.keyboard.press("Escape");
    await visit.stop();
    await visit.says(".notice", /does not answer/);
    assert.deepEqual(await visit.faults(), []);
  }));
}

for (const [name, size] of [["a phone", [390, 844]], ["a phone held across", [844, 390]], ["a tablet", [800, 1100]]]) {
  test(`${name} shows the map and what is amiss`, visiting({ start_s: 50, size, touch: true }, async (visit) => {
    visit.mock.program.run.scaleKnown = false;
    await visit.page.locator("header .scale").waitFor({ state: "visible" });
    for (const selector of ["header .scale", ".tools", ".timeline"]) await inside(visit, selector);
    await visit.until(async () => (await visit.page.locator(".label.camera:visible").count()) === 3);
    for (const camera of ["cam0", "cam1", "cam2"]) await inside(visit, `.label[data-camera=${camera}]`);
    await visit.page.locator("header .scale").click();
    await visit.says(".toasts", /units of the map/);
    assert.deepEqual(await visit.faults(), []);
  }));
}

test("a phone that is turned shows all of it again", visiting({ start_s: 50, size: [390, 844], touch: true }, async (visit) => {
  await visit.until(async () => (await visit.page.locator(".label.camera:visible").count()) === 3);
  await visit.page.setViewportSize({ width: 844, height: 390 });
  await visit.frames();
  await visit.until(async () => (await visit.page.locator(".label.camera:visible").count()) === 3);
  for (const camera of ["cam0", "cam1", "cam2"]) await inside(visit, `.label[data-camera=${camera}]`);
}));

test("what a camera sees is shown while it is wanted", visiting({ start_s: 50 }, async (visit) => {
  const requests = [];
  visit.page.on("request", (request) => { if (request.url().includes("thumbnail")) requests.push(request.url()); });
  await visit.page.click(".agent[data-agent=cam0] .head");
  await visit.page.getByLabel("Image of what cam1 sees").waitFor({ state: "hidden" });
  assert.equal(requests.length, 0);
  await visit.page.getByLabel("Image of what cam0 sees").click();
  await visit.page.getByAltText("What cam0 sees").waitFor({ state: "visible" });
  assert.ok(requests.every((url) => url.endsWith("thumbnail?agent=cam0")));
  assert.deepEqual(await visit.faults(), []);
  await visit.page.click(".agent[data-agent=cam0] .head");
  const asked = requests.length;
  await visit.page.waitForTimeout(1500);
  assert.equal(requests.length, asked);
}));

test("an agent that gives no images says so", visiting({ start_s: 50, thumbnails: false }, async (visit) => {
  await visit.page.click(".agent[data-agent=cam0] .head");
  await visit.page.getByLabel("Image of what cam0 sees").click();
  await visit.says(".agent[data-agent=cam0] .thumbnail", /cam0 keeps its images to itself/);
}));

test("a run that is played slowly is not said to be behind", visiting({ start_s: 50, rate: 0.5 }, async (visit) => {
  await visit.says(".pill", /^live, ×0\.[4-6]$/);
  await visit.page.locator(".agent[data-agent=cam0] .short [data-key=lag]").waitFor({ state: "hidden" });
}));
