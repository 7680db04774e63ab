// Fifty people look at 24 axes that move, and one of them stops all. Not run with the other tests: it keeps a computer busy
// for minutes. PAGES says how many look, ROUNDS how often all is stopped, each time by another one.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, it } from "node:test";
import { axis, Bench, button, card, closeBrowser, open, until } from "./bench.mjs";

const modules = 4;
const motors = 6;
const pages = Number(process.env.PAGES ?? 50);
const rounds = Number(process.env.ROUNDS ?? 20);
const measuredMs = 20_000;
const ticksPerSecond = 100;

const names = Array.from({ length: modules * motors }, (_, index) => `a${index + 1}`);
const moduleOf = (index) => 1 + Math.floor(index / motors);

after(closeBrowser);

it("has every page follow, and stops all axes for any of them", { timeout: 1_800_000 }, async () => {
  const bench = await Bench.create({
    axes: names.map((name, index) => axis(name, index % motors, moduleOf(index))).join(""),
    models: Array(modules).fill("TMCM-6212"),
  });
  const all = (method, more = {}) => Promise.all(names.map((name) => bench.call(method, { axis: name, ...more })));
  const states = () => all("axis.get_state");
  const processorSeconds = async () => {
    const fields = (await readFile(`/proc/${bench.daemon.process.pid}/stat`, "utf8")).split(") ")[1].split(" ");
    return (Number(fields[11]) + Number(fields[12])) / ticksPerSecond;
  };
  for (const name of names) await bench.call("parameter.set", { axis: name, parameter: "max_velocity", value: 5000 });
  const setOut = async () => {
    await Promise.all((await states()).map(({ axis: name, position }) => bench.call("axis.move_to", { axis: name, position: position < 0 ? 190 : -190 })));
    await until("all move", async () => (await states()).every(({ moving }) => moving));
  };

  const people = [];
  for (let index = 0; index < pages; ++index) {
    people.push(await open(bench.url));
    await card(people[index], names.at(-1)).waitFor();
  }
  await setOut();
  const [began, before] = [Date.now(), await processorSeconds()];
  await new Promise((done) => setTimeout(done, measuredMs));
  const used = ((await processorSeconds()) - before) / ((Date.now() - began) / 1000);
  console.log(`tmcld takes ${Math.round(100 * used)} % of a processor for ${pages} pages and ${names.length} axes`);

  const waited = [];
  for (let round = 0; round < rounds; ++round) {
    await setOut();
    const page = people[(round * 7) % pages];
    const pressed = page.evaluate(() => new Promise((done) => addEventListener("click", () => done(Date.now()), { capture: true, once: true })));
    await button(page, "Stop all").click();
    await page.getByText(/^All stand: /).waitFor();
    waited.push(Date.now() - (await pressed));
    assert.ok((await states()).every(({ moving }) => !moving));
  }
  waited.sort((one, other) => one - other);
  console.log(`from the press until the page says that all stand: ${waited[Math.floor(rounds / 2)]} ms in the middle, ${waited.at(-1)} ms at most`);

  // What a page shows is what there is, in the end.
  const last = await states();
  const shown = (page) => page.locator("[data-axis] p.position").evaluateAll((all) => all.map(({ textContent }) => parseFloat(textContent.replace("\u2212", "-"))));
  for (const page of people)
    await until("the axes are shown where they are", async () => (await shown(page)).every((position, index) => Math.abs(position - last[index].position) < 0.01));
  assert.deepEqual(people.flatMap((page) => page.complaints), []);
  await Promise.all(people.map((page) => page.context().close()));
  await bench.end();
});
