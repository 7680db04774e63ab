// How the page of a fleet bears 1,000 gateways with six axes each, of which all tell something twice a second. Not run with
// the other tests: it keeps a computer busy. GATEWAYS and RATE (messages a second) say how much.
//
// Chromium runs without its debugger, which would be told each message, too: a page around the page looks on, and reports.
import assert from "node:assert/strict";
import { mkdtemp, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { it } from "node:test";
import { freePort, Program } from "./bench.mjs";
import { Broker, password } from "./fleet_bench.mjs";

const gateways = Number(process.env.GATEWAYS ?? 1000);
const rate = Number(process.env.RATE ?? 12_000);
const axes = 6;
const measuredMs = 20_000;
const rounds = 10;

/** Runs in the page around. */
async function lookOn({ user, password, gateways, axes, measuredMs, rounds, to }) {
  const pause = (ms) => new Promise((done) => setTimeout(done, ms));
  const tell = (what) => fetch(to, { method: "POST", mode: "no-cors", body: JSON.stringify(what) });
  const until = async (condition) => {
    const ends = performance.now() + 60_000;
    while (!condition()) {
      if (performance.now() > ends) throw new Error(`has not come about: ${condition}; ${page.body.innerText.slice(0, 500)}`);
      await pause(5);
    }
  };
  const inner = document.querySelector("iframe").contentWindow;
  let page = inner.document;
  const button = (text) => [...page.querySelectorAll("button")].find((one) => one.textContent === text);
  const shows = (text) => page.body.innerText.includes(text);
  const fill = (label, text) => {
    const field = page.querySelector(`[aria-label="${label}"]`);
    field.value = text;
    field.dispatchEvent(new inner.Event("input", { bubbles: true }));
  };
  try {
    await until(() => page.querySelector("form"));
    fill("User name", user);
    fill("Password", password);
    await pause(100);
    const began = performance.now();
    button("Connect").click();
    await until(() => shows(`${gateways} gateways: ${gateways} online, 0 away`) && shows(`${gateways * axes} axes: `));
    await tell({ shownAfterMs: Math.round(performance.now() - began) });
    const gaps = [];
    const ends = performance.now() + measuredMs;
    const places = new Set();
    for (let last = performance.now(); last < ends; ) {
      const now = await new Promise(inner.requestAnimationFrame);
      gaps.push(now - last);
      last = now;
      const position = page.querySelector("[data-axis] .number")?.textContent;
      if (position) places.add(position);
    }
    gaps.sort((one, other) => one - other);
    const part = (share) => Math.round(gaps[Math.floor(share * (gaps.length - 1))]);
    await tell({ framesPerSecond: Math.round((1000 * gaps.length) / measuredMs), medianMs: part(0.5), p99Ms: part(0.99), longestMs: part(1), placesOfOneAxis: places.size, rows: page.querySelectorAll("[data-row]").length });
    const waited = [];
    for (let round = 0; round < rounds; ++round) {
      const pressed = performance.now();
      button("Stop all").dispatchEvent(new inner.PointerEvent("pointerdown", { bubbles: true }));
      await pause(20);
      await until(() => shows(`Stopped: ${gateways * axes} axes of ${gateways} gateways`));
      waited.push(Math.round(performance.now() - pressed));
      await pause(500);
    }
    waited.sort((one, other) => one - other);
    await tell({ stopMedianMs: waited[Math.floor(rounds / 2)], stopLongestMs: waited.at(-1), heapMB: Math.round(performance.memory.usedJSHeapSize / 1e6), isOver: true });
  } catch (error) {
    await tell({ error: String(error), isOver: true });
  }
}

async function listen() {
  const told = [];
  let isOver;
  const over = new Promise((done) => (isOver = done));
  const port = await freePort();
  const server = createServer(async (request, response) => {
    let text = "";
    for await (const part of request) text += part;
    response.end();
    const said = JSON.parse(text);
    told.push(said);
    if (said.isOver) isOver();
  }).listen(port, "127.0.0.1");
  return { url: `http://localhost:${port}/`, told, over, end: () => server.close() };
}

for (const kind of ["state", "telemetry"]) {
  it(`follows ${gateways} gateways that tell ${kind}`, { timeout: 600_000 }, async () => {
    const broker = await Broker.create();
    const reports = await listen();
    const setUp = { user: "anna", password, gateways, axes, measuredMs, rounds, to: reports.url };
    await writeFile(
      join(broker.files, "around.html"),
      `<!doctype html><body style="margin:0"><iframe src="index.html" style="width:100%;height:95vh;border:0"></iframe><script>onload = () => (${lookOn})(${JSON.stringify(setUp)})</script>`,
    );
    const many = new Program(process.execPath, join(process.cwd(), "many_gateways.mjs"), broker.plainPort, gateways, axes, kind, rate);
    await many.says("born");
    const profile = await mkdtemp(join(tmpdir(), "tmcl-load-"));
    const words = ["--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1280,800", `--user-data-dir=${profile}`];
    const browser = new Program(process.env.TMCL_CHROMIUM ?? "/usr/bin/chromium", ...words, `http://localhost:${broker.filesPort}/around.html`);
    await reports.over;
    for (const told of reports.told) console.log(kind, JSON.stringify(told));
    console.log(kind, many.output.trim().split("\n").at(-1));
    await browser.end();
    await many.end();
    await broker.end();
    reports.end();
    await rm(profile, { recursive: true, force: true, maxRetries: 5 });
    assert.ok(!reports.told.some(({ error }) => error));
  });
}
