// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { Visit } from "./browser.mjs";

let visit;

before(async () => { visit = await Visit.begin({ start_s: 50 }); });
after(() => visit.end());

const layer = (name) => visit.page.getByLabel(name, { exact: true });
const seconds = async () => {
  const [minutes, rest] = (await visit.text(".time")).split(":").map(Number);
  return 60 * minutes + rest;
};

test("points, cameras and what moves are drawn", async () => {
  await visit.says(".pill", /^live/);
  await visit.says(".figures", /points/);
  await visit.pixelsUntil("point", (count) => count > 800);
  await visit.pixelsUntil("moving", (count) => count > 100);
  await visit.until(async () => (await visit.page.locator(".label.camera:visible").count()) === 3);
  await visit.says(".label.object", /object 7/);
});

test("what is not wanted is not drawn", async () => {
  const all = (await visit.pixels("point")).count;
  const flip = () => visit.page.getByLabel("What is shown, and in which colours").click();
  await flip();
  await layer("Static points").uncheck();
  await flip();
  await visit.pixelsUntil("point", (count) => count < 0.3 * all);
  await flip();
  await layer("Static points").check();
  await flip();
  await visit.pixelsUntil("point", (count) => count > 0.7 * all);
});

test("a point is picked and tells its life", async () => {
  await visit.page.keyboard.press("t");
  await visit.frames();
  const { some } = await visit.pixelsUntil("point", (count) => count > 800);
  for (const [x, y] of some) {
    await visit.page.mouse.click(x, y);
    await visit.frames();
    const title = visit.page.locator(".inspector h2");
    if ((await title.isVisible()) && /^Point \d+/.test(await title.textContent())) break;
  }
  await visit.says(".inspector h2", /^Point \d+/);
  await visit.says(".inspector .life", /It was made by cam0/);
  await visit.says(".facts", /Axes, 1 σ.*cm/);
  await visit.says(".facts", /Position.*x .* y .* z .* m.*In framemap/);
  await visit.page.locator(".label.ring").waitFor({ state: "visible" });
  await visit.page.keyboard.down("Shift");
  for (const [x, y] of some.toReversed()) {
    await visit.page.mouse.click(x, y);
    await visit.frames();
    if (/To (point|camera|moving)/.test(await visit.text(".facts"))) break;
  }
  await visit.page.keyboard.up("Shift");
  await visit.says(".facts", /To .*\d.* m ± /);
  await visit.says(".label.length", /m ± /);
  await visit.page.keyboard.press("Escape");
  await visit.page.locator(".label.length").waitFor({ state: "hidden" });
  await visit.page.keyboard.press("Escape");
  await visit.page.locator(".inspector").waitFor({ state: "hidden" });
});

test("a card shows what the camera sees", async () => {
  await visit.page.click(".agent[data-agent=cam0] .head");
  await visit.says(".agent[data-agent=cam0] .long", /on the map/);
  await visit.page.waitForFunction(() => {
    const plane = document.querySelector(".agent[data-agent=cam0] canvas");
    const { data } = plane.getContext("2d").getImageData(0, 0, plane.width, plane.height);
    let dots = 0;
    for (let i = 3; i < data.length; i += 4) dots += data[i] > 0;
    return dots > 300;
  });
  await visit.page.click(".agent[data-agent=cam0] .head");
});

test("each camera has its colour", async () => {
  const colours = await visit.page.locator(".agent").evaluateAll((cards) => cards.map((card) => card.style.getPropertyValue("--colour")));
  assert.deepEqual(colours, ["var(--camera-0)", "var(--camera-1)", "var(--camera-2)"]);
});

test("an opened card has plots", async () => {
  await visit.page.click(".agent[data-agent=cam2] .head");
  await visit.says(".agent[data-agent=cam2] .plots", /tracks.*ms a frame.*ms lag.*kB\/s up/);
  await visit.page.waitForFunction(() => [...document.querySelectorAll(".agent[data-agent=cam2] .spark")].every((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, Math.max(1, canvas.height - 4));
    return data.some((value, i) => i % 4 === 3 && value > 0);
  }));
  await visit.page.click(".agent[data-agent=cam2] .head");
});

test("colours have a scale with numbers", async () => {
  await visit.page.getByLabel("What is shown, and in which colours").click();
  const by = (name) => visit.page.locator(`.choice input[value=${name}]`).check({ force: true });
  await by("certainty");
  await visit.says(".legend .scale", /[cm]m.*deviation.*[cm]m/);
  await by("height");
  await visit.says(".legend .scale", /0.*height.* m/);
  await by("state");
  await visit.page.locator(".legend .scale").waitFor({ state: "hidden" });
});

test("the map and a picture of it are saved", async () => {
  const map = await visit.saved(() => visit.page.getByText("Save map").click());
  assert.equal(map.name, "map.ply");
  const head = /^ply\nformat binary_little_endian 1.0\ncomment lengths in metres\nelement vertex (\d+)\n[^]*?end_header\n/.exec(map.octets.toString("latin1"));
  assert.ok(Number(head[1]) > 500);
  assert.equal(map.octets.length, head[0].length + 20 * Number(head[1]));
  const picture = await visit.saved(() => visit.page.getByText("Save picture").click());
  assert.equal(picture.name, "coslam.png");
  assert.ok(picture.octets.length > 20000);
  await visit.page.getByLabel("What is shown, and in which colours").click();
});

test("from above, from the side, and the sheet of keys", async () => {
  const axes = () => visit.page.locator(".gizmo").evaluate((canvas) => canvas.toDataURL());
  const before = await axes();
  await visit.page.keyboard.press("p");
  await visit.until(async () => (await axes()) !== before);
  const side = await axes();
  await visit.page.keyboard.press("t");
  await visit.until(async () => (await axes()) !== side);
  const above = await axes();
  await visit.page.keyboard.press("p");
  await visit.until(async () => (await axes()) !== above);
  await visit.page.keyboard.press("?");
  await visit.says(".help[open]", /from above, and back/);
  await visit.page.keyboard.press("Escape");
  await visit.page.locator(".help").waitFor({ state: "hidden" });
});

test("who is lost is seen, and why", async () => {
  await visit.says(".agent[data-agent=cam1] .state", /tracking/);
  visit.mock.program.lose("cam1");
  await visit.says(".agent[data-agent=cam1] .state", /lost for/);
  await visit.says(".agent[data-agent=cam1] .why", /Unknown place.*12 are needed/);
  await visit.says(".news", /cam1 lost its pose/);
  await visit.says(".label.lost", /cam1/);
});

test("the time line is dragged, and left again", async () => {
  const box = await visit.page.locator(".track").boundingBox();
  const now = await seconds();
  await visit.page.mouse.move(box.x + 0.8 * box.width, box.y + 30);
  await visit.page.mouse.down();
  await visit.page.mouse.move(box.x + 0.1 * box.width, box.y + 30, { steps: 8 });
  await visit.page.mouse.up();
  await visit.says(".pill", /looking back/);
  await visit.until(async () => (await seconds()) < now - 1);
  const then = await seconds();
  await visit.says(".agent[data-agent=cam1] .state", /tracking/);
  await visit.page.keyboard.press("l");
  await visit.says(".pill", /^live/);
  await visit.until(async () => (await seconds()) > then + 1);
});

test("a camera is followed, and looked through", async () => {
  await visit.page.click(".agent[data-agent=cam2] .head");
  const card = visit.page.locator(".agent[data-agent=cam2]");
  await card.getByLabel("Follow cam2").click();
  await visit.page.waitForSelector(".agent[data-agent=cam2] [aria-pressed=true]");
  await card.getByLabel("Look through cam2").click();
  await visit.pixelsUntil("point", (count) => count > 100);
  await visit.page.keyboard.press("Escape");
  await visit.page.keyboard.press("f");
});

test("dark becomes light", async () => {
  const background = () => visit.page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const dark = await background();
  await visit.page.getByLabel("Light or dark").click();
  assert.notEqual(await background(), dark);
  await visit.page.getByLabel("Light or dark").click();
  assert.equal(await background(), dark);
});

test("until here the console has no error", () => assert.deepEqual(visit.errors, []));

test("a server that dies is said to be gone, and heard again", async () => {
  await visit.stop();
  await visit.says(".pill", /no connection/);
  await visit.says(".notice", /does not answer.*Next try in/);
  await visit.says(".notice", /Next try in [23] s/);  // the pauses grow
  await visit.restart({ start_s: 180 });
  await visit.says(".pill", /^live/);
  await visit.says(".time", /^3:/);
  await visit.page.locator(".notice").waitFor({ state: "hidden" });
  await visit.pixelsUntil("point", (count) => count > 800);
  const others = visit.errors.filter((text) => !/ERR_CONNECTION|WebSocket connection to/.test(text));
  assert.deepEqual(others, []);
});

test("a new run begins on an empty page", async () => {
  await visit.stop();
  await visit.says(".pill", /no connection/);
  await visit.restart({ start_s: 16, run: "77777777" });
  await visit.says(".run", /77777777/);
  await visit.says(".time", /^0:/);
  await visit.pixelsUntil("point", (count) => count > 800);
});

test("a tablet held upright shows all of it", async () => {
  await visit.page.setViewportSize({ width: 800, height: 1100 });
  await visit.page.waitForFunction(() => window.innerWidth === 800 && document.documentElement.scrollWidth <= 800 && document.querySelector("header").offsetWidth === 800);
  for (const selector of ["header", ".agents", ".timeline", ".stage canvas"]) {
    const box = await visit.page.locator(selector).boundingBox();
    assert.ok(box.width <= 800 && box.height > 20, `${selector}: ${JSON.stringify(box)}`);
  }
});
