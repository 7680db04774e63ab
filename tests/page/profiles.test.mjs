// Ramp generators on the page: the same move with each chip, as tmcld computes it.
import assert from "node:assert/strict";
import { after, afterEach, beforeEach, describe, it } from "node:test";
import { Bench, button, closeBrowser, open, seriousFindings, signIn, until } from "./bench.mjs";

let bench, page;
after(closeBrowser);
afterEach(async () => {
  await page.context().close();
  await bench.end();
});

const show = async (query = "", options = {}) => {
  page = await open(`${bench.url}/?tab=profiles${query}`, options);
};
const chip = (name) => page.getByRole("article", { name, exact: true });
const value = (name, register) => chip(name).getByRole("textbox", { name: register });
const result = async (row, column) => page.getByRole("row", { name: new RegExp(`^${row}`) }).getByRole("cell").nth(column).textContent();
const time = (column) => result("Time of the move", column);
const columns = { TMC429: 0, TMC457: 1, sixPoint: 2, MC1451A: 3 };
const isComputed = (column) => until("a time", async () => Number(await time(column)) > 0);

describe("profiles", () => {
  beforeEach(async () => {
    bench = await Bench.create();
  });
  afterEach(() => assert.deepEqual(page.complaints, []));

  for (const [name, register, slower] of [
    ["TMC429", /^V_MAX /, "500"],
    ["TMC457", /^V_MAX /, "1500000"],
    ["sixPoint", /^VMAX /, "25000"],
    ["MC1451A", /^Velocity /, "1638400"],
  ]) {
    it(`tells what tmcld computes for a ${name}, and follows its input`, async () => {
      await show();
      const column = columns[name];
      await isComputed(column);
      const before = Number(await time(column));
      await value(name, register).fill(slower);
      await until("the move takes longer", async () => Number(await time(column)) > before * 1.2);
      await page.locator(".profiles canvas").nth(2).waitFor();
      const words = new URL(page.url()).searchParams;
      assert.ok(words.get(name).split(",").includes(slower), "the address has it");
    });
  }

  it("draws the ramps of the chips", async () => {
    await show();
    for (const column of [0, 1, 2, 3]) await isComputed(column);
    const coloured = () =>
      page.evaluate(() =>
        [...document.querySelectorAll(".profiles canvas")].map((canvas) => {
          const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          const seen = [0, 0, 0, 0];
          const colours = [[0x2f, 0x9e, 0x6e], [0xd9, 0x82, 0x2b], [0x5b, 0x8d, 0xef], [0xd6, 0x4f, 0x7f]];
          for (let at = 0; at < data.length; at += 4)
            colours.forEach((colour, index) => colour.every((part, byte) => Math.abs(data[at + byte] - part) < 8) && ++seen[index]);
          return seen.every((count) => count > 50);
        }));
    await until("four curves in three pictures", async () => {
      const all = await coloured();
      return all.length === 3 && all.every(Boolean);
    });
  });

  it("tells a refused value at its input", async () => {
    await show();
    await value("TMC457", /^BOW_MAX /).fill("44");
    const place = chip("TMC457").locator(".register", { hasText: "BOW_MAX" });
    await place.getByRole("alert").getByText(/does not take 44/).waitFor();
    assert.equal(await value("TMC457", /^BOW_MAX /).getAttribute("aria-invalid"), "true");
    assert.equal(await page.getByRole("alert").count(), 1);
    await value("TMC457", /^BOW_MAX /).fill("half");
    await place.getByRole("alert").getByText("That is no whole number").waitFor();
    await value("TMC457", /^BOW_MAX /).fill("5");
    await isComputed(columns.TMC457);
    assert.equal(await page.getByRole("alert").count(), 0);
    await page.getByLabel("Distance in µsteps").fill("3000000000");
    await page.getByRole("alert").getByText(/distance_microsteps/).waitFor();
  });

  it("tells a refused register of a chip that is in no module, and sets it on no axis", async () => {
    await show();
    await isComputed(columns.MC1451A);
    await value("MC1451A", /^Acceleration /).fill("32768");
    const place = chip("MC1451A").locator(".register", { hasText: "Acceleration" });
    await place.getByRole("alert").getByText(/does not take 32768/).waitFor();
    assert.equal(await page.getByRole("alert").count(), 1);
    await value("MC1451A", /^Acceleration /).fill("1310");
    await isComputed(columns.MC1451A);
    assert.equal(await chip("MC1451A").getByRole("button").count(), 0);
    // Half the cycle is twice the speed.
    const speed = async () => Number(await result("Top speed", columns.MC1451A));
    await value("MC1451A", /^Acceleration /).fill("13107");
    await until("its speed", async () => Math.abs((await speed()) - 50000) < 10);
    await value("MC1451A", /^Cycle /).fill("500");
    await until("the speed of a shorter cycle", async () => Math.abs((await speed()) - 100000) < 20);
  });

  it("lets no old answer overwrite a newer one", async () => {
    page = await open("about:blank");
    // The answer for 20000 comes after the one for 10000, which was asked later.
    let late;
    await page.routeWebSocket("**/ws", (socket) => {
      const tmcld = socket.connectToServer();
      let held = null;
      socket.onMessage((text) => {
        const { id, params } = JSON.parse(text);
        if (params?.model === "TMCM-6212" && params.values[0] === 20000) held = id;
        tmcld.send(text);
      });
      tmcld.onMessage((text) => {
        if (held !== null && JSON.parse(text).id === held) late = () => socket.send(text);
        else socket.send(text);
      });
    });
    await page.goto(`${bench.url}/?tab=profiles`);
    await isComputed(columns.sixPoint);
    await value("sixPoint", /^VMAX /).fill("20000");
    await until("the answer is held back", () => late);
    await value("sixPoint", /^VMAX /).fill("10000");
    const speed = async () => Number(await result("Top speed", columns.sixPoint));
    await until("the newer answer", async () => Math.abs((await speed()) - 10000) < 100);
    late();
    // Whatever came before this answer has been taken when it is there.
    await value("TMC429", /^V_MAX /).fill("400");
    await until("a later answer", async () => Number(await result("Top speed", columns.TMC429)) < 20000);
    assert.ok(Math.abs((await speed()) - 10000) < 100);
  });

  it("is in the address as it was set up", async () => {
    await show("&distance=7000&sixPoint=30000,90000,80000,40000,5000,30000");
    await isComputed(columns.sixPoint);
    assert.equal(await page.getByLabel("Distance in µsteps").inputValue(), "7000");
    assert.equal(await value("sixPoint", /^DMAX /).inputValue(), "80000");
    await value("sixPoint", /^D1 /).fill("20000");
    await until("the address", () => new URL(page.url()).searchParams.get("sixPoint") === "30000,90000,80000,40000,5000,20000");
    const link = page.url();
    await page.context().close();
    page = await open(link);
    await isComputed(columns.sixPoint);
    assert.equal(await value("sixPoint", /^D1 /).inputValue(), "20000");
  });

  it("sets the registers on an axis with that chip", async () => {
    await show();
    await value("TMC429", /^A_MAX /).fill("321");
    await button(chip("TMC429"), "Set on x").click();
    await page.getByText("x is set").waitFor();
    assert.equal((await bench.call("parameter.get", { axis: "x", parameter: "max_acceleration" })).value, 321);
    assert.equal(await chip("sixPoint").getByRole("button").count(), 0, "no axis has that chip");
  });

  it("lays the next move of an axis over the pictures", async () => {
    await show();
    await isComputed(columns.TMC429);
    await button(page, "Record its next move").click();
    await page.getByText("It waits until the axis moves.").waitFor();
    await bench.call("axis.move_to", { axis: "x", position_microsteps: -20000 });
    await page.getByText(/^A move of x that took \d/).waitFor();
    const curves = page.locator(".profiles .u-label").getByText("x", { exact: true });
    await until("it is in each picture", async () => (await curves.count()) === 3);
    await button(page, "Remove what was recorded").click();
    await page.getByText(/^A move of x/).waitFor({ state: "detached" });
    await until("it is in none", async () => (await curves.count()) === 0);
  });

  it("can be read by a screen reader, on a phone", async () => {
    await show("", { bypassCSP: true, viewport: { width: 360, height: 740 } });
    for (const column of [0, 1, 2, 3]) await isComputed(column);
    await value("TMC457", /^BOW_MAX /).fill("44");
    await page.getByRole("alert").waitFor();
    assert.deepEqual(await seriousFindings(page), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
  });
});

describe("profiles for a guest", () => {
  it("are computed, and set on no axis", async () => {
    bench = await Bench.create({ keys: "" });
    await show();
    await signIn(page, await bench.token("observe", "guest"));
    await isComputed(columns.TMC429);
    assert.equal(await page.getByRole("button", { name: /^Set on/ }).count(), 0);
  });
});
