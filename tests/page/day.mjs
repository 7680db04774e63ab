// A day of states of three axes, 50 a second of each, with a move a minute: what the page keeps in memory does not grow.
// Not run with the other tests: it takes minutes. HOURS says how long a day is.
import assert from "node:assert/strict";
import { after, it } from "node:test";
import { Bench, button, card, closeBrowser, open, until } from "./bench.mjs";

const hours = Number(process.env.HOURS ?? 24);
const allowedMb = 2;
const names = ["x", "y", "z"];

after(closeBrowser);

/** Runs in the page, before its scripts. `window.tellHour` makes up an hour of states; from then on those of tmcld are kept out. */
function pretend() {
  const stateMs = 20;
  const perMinute = 3000;
  const atOnce = 2000; // between them the page may draw
  const last = new Map();
  let [socket, isOver] = [null, false];
  window.WebSocket = class extends WebSocket {
    constructor(...words) {
      super(...words);
      socket = this;
      this.addEventListener("message", (event) => {
        if (!event.isTrusted) return;
        const { method, params } = JSON.parse(event.data);
        if (method !== "notify_state") return;
        if (isOver) event.stopImmediatePropagation();
        else last.set(`${params.subscription} ${params.axis}`, params);
      });
    }
  };

  // Half of each minute it moves, there and back.
  const next = (state, count) => {
    const [minute, part] = [Math.floor(count / perMinute), (count % perMinute) / perMinute];
    const [from, to] = minute % 2 === 0 ? [10, 60] : [60, 10];
    const position = from + (to - from) * Math.min(1, 2 * part);
    const moving = part > 0 && part < 0.5;
    Object.assign(state, { seq: state.seq + 1, event_time_ms: state.event_time_ms + stateMs, moving, position_reached: !moving });
    Object.assign(state, { position, position_microsteps: Math.round(position * 6400), target: to, target_microsteps: to * 6400 });
    Object.assign(state, { velocity: moving ? (to - from) / 30 : 0 });
  };
  let count = 0;
  window.tellHour = async () => {
    isOver = true;
    for (const end = count + 60 * perMinute; count < end; ++count) {
      for (const params of last.values()) {
        next(params, count);
        socket.dispatchEvent(new MessageEvent("message", { data: JSON.stringify({ jsonrpc: "2.0", method: "notify_state", params }) }));
      }
      if (count % atOnce === 0) await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    }
  };
}

it(`keeps no more in memory after ${hours} hours than after one`, { timeout: 3_600_000 }, async () => {
  const bench = await Bench.create();
  const page = await open("about:blank");
  await page.addInitScript(pretend);
  await page.goto(bench.url);
  await card(page, "z").waitFor();
  const scope = page.getByRole("region", { name: "Scope" });
  for (const name of names) {
    for (const value of name === "z" ? ["position", "velocity"] : ["position", "velocity", "target"]) {
      await scope.getByLabel("Axis").selectOption(name);
      await scope.getByLabel("Value").fill(value);
      await button(scope, "Add").click();
    }
  }
  await page.locator(".plot canvas").first().waitFor();
  await until("all axes are told of", () => page.evaluate(() => document.querySelectorAll("[data-axis]").length === 3));

  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable");
  const inUse = async () => {
    await session.send("HeapProfiler.collectGarbage");
    const { metrics } = await session.send("Performance.getMetrics");
    const of = (name) => metrics.find((metric) => metric.name === name).value;
    return { mb: of("JSHeapUsedSize") / 2 ** 20, nodes: of("Nodes"), listeners: of("JSEventListeners") };
  };
  const told = [];
  for (let hour = 1; hour <= hours; ++hour) {
    await page.evaluate(() => window.tellHour());
    told.push(await inUse());
    const { mb, nodes, listeners } = told.at(-1);
    console.log(`after hour ${hour}: ${mb.toFixed(2)} MB, ${nodes} nodes, ${listeners} listeners`);
  }
  await card(page, "x").getByText("10 mm").first().waitFor();
  const [first, last] = [told[0], told.at(-1)];
  assert.ok(last.mb < first.mb + allowedMb, `${first.mb} MB after an hour, ${last.mb} MB at the end`);
  assert.ok(last.nodes <= 2 * first.nodes && last.listeners <= 2 * first.listeners);
  assert.deepEqual(page.complaints, []);
  await page.context().close();
  await bench.end();
});
