// How the page looks, against the pictures in docs/page.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { after, afterEach, beforeEach, describe, it } from "node:test";
import { Bench, button, card, closeBrowser, open, until } from "./bench.mjs";
import { difference, folder, look, looksLike, mostDifferent, skip } from "./looks.mjs";

const part = "G21 G90\nF1200\nG1 X10 Y0\nG2 X0 Y10 I-10 J0\nG1 X10 Y10\nG2 X10 Y0 I0 J-5\nM2\n";

let bench, page;
after(closeBrowser);
afterEach(async () => {
  await page.context().close();
  await bench.end();
});

describe("the page looks as it did", { skip }, () => {
  beforeEach(async () => {
    bench = await Bench.create();
  });
  const show = async (query = "", options = {}) => {
    page = await open(`${bench.url}/${query}`, { viewport: { width: 1280, height: 800 }, ...options });
    await button(page, "Stop all").waitFor();
  };
  const goTo = async (positions) => {
    for (const [name, position] of Object.entries(positions)) {
      await bench.call("axis.move_to", { axis: name, position });
      await bench.stands(name);
      const shown = () => card(page, name).textContent();
      await until(`${name} is shown there`, async () => (await shown()).includes(`${position} mm`) && (await shown()).includes("stands"));
    }
  };

  it("with axes and a scope", async () => {
    await show();
    for (const value of ["position", "velocity"]) {
      await page.getByRole("region", { name: "Scope" }).getByLabel("Value").fill(value);
      await button(page, "Add").click();
    }
    await page.locator(".plot canvas").first().waitFor();
    await goTo({ y: -60, z: 7.5 });
    await until("a move that was foreseen", async () => {
      await goTo({ x: 0 });
      await goTo({ x: 20 });
      return (await page.locator(".plot .uplot").count()) > 1;
    });
    await button(page, "Pause").click();
    const plot = page.locator(".plot");
    await looksLike(page, "axes", [plot]);
    // A card that is missing makes the comparison fail.
    await card(page, "y").evaluate((element) => (element.style.visibility = "hidden"));
    const share = await difference(await readFile(join(folder, "axes.png")), await look(page), [await plot.boundingBox()]);
    assert.ok(share > mostDifferent, `a card that is gone is ${share} of the blocks`);
  });

  it("in the dark, with a module that has started again", async () => {
    await show("", { colorScheme: "dark" });
    await goTo({ x: 20, y: -60 });
    await bench.call("module.reset", { bus: "bench", address: 1 });
    for (const name of ["x", "y", "z"]) await until(`${name} may be recovered`, () => button(card(page, name), "Recover").isEnabled());
    await looksLike(page, "dark");
  });

  it("on a phone", async () => {
    await show("", { viewport: { width: 360, height: 640 } });
    await goTo({ x: 20 });
    await looksLike(page, "phone");
  });

  it("with a path", async () => {
    await show("?tab=paths");
    await page.getByLabel("Path file").setInputFiles({ name: "part.ngc", mimeType: "text/plain", buffer: Buffer.from(part) });
    await until("it may be run", () => button(page, "Run").isEnabled());
    await page.getByText("Expected in each mode").waitFor();
    // A bus that was measured as slow brings warnings, which move the tables down.
    const warnings = page.locator(".paths p.problem");
    await warnings.evaluateAll((all) => all.forEach((one) => (one.style.display = "none")));
    await looksLike(page, "paths", [page.getByRole("table").last()]);
  });

  it("with the ramps of four chips", async () => {
    await show("?tab=profiles");
    await until("all are computed", async () => {
      const times = await page.getByRole("row", { name: /^Time of the move/ }).getByRole("cell").allTextContents();
      return times.length >= 4 && times.every((time) => Number(time) > 0);
    });
    await looksLike(page, "profiles");
  });
});

it("looks as it did before a sign-in", { skip }, async () => {
  bench = await Bench.create({ keys: "" });
  page = await open(bench.url, { viewport: { width: 1280, height: 400 } });
  await page.getByLabel("Token").waitFor();
  await looksLike(page, "sign-in");
});
