// Files of paths on the page: dropped, planned, drawn, passed.
import assert from "node:assert/strict";
import { after, afterEach, beforeEach, describe, it } from "node:test";
import { Bench, axis, button, closeBrowser, open, seriousFindings, signIn, until } from "./bench.mjs";

const square = "G21 G90\nF1200\nG1 X10 Y0\nG1 X10 Y10\nG1 X0 Y10\nM2\n";
const longWay = "G21 G90\nF600\nG1 X150 Y0\nM2\n";
const stairs = "G21 G90\nF1200\nG1 X10 Y0 Z0\nG1 X10 Y10 Z4\nG1 X0 Y10 Z8\nM2\n";
const elsewhere = "t,a,b\n0,0,0\n1,4,0\n2,4,3\n";
const html = '<img src="x" onerror="document.title = 1">.ngc';

let bench, page;
after(closeBrowser);

const show = async (options) => {
  page = await open(`${bench.url}/?tab=paths`, options);
};
const choose = (name, text) =>
  page.getByLabel("Path file").setInputFiles({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
const drop = async (name, text) => {
  const dataTransfer = await page.evaluateHandle(
    ([name, text]) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([text], name));
      return transfer;
    },
    [name, text],
  );
  await page.locator(".drop").dispatchEvent("drop", { dataTransfer });
};
const run = async () => {
  await until("it may be run", () => button(page, "Run").isEnabled());
  await button(page, "Run").click();
};
/** On a machine that is too busy to pass a path, tmcld ends it as starved: it is planned and run anew then. */
const unlessStarved = async (scenario) => {
  for (let triesLeft = 8; ; --triesLeft) {
    try {
      return await scenario();
    } catch (error) {
      if (triesLeft === 0 || !(await hasStarved())) throw error;
      await button(page, "Dry run").click();
    }
  }
};
const hasStarved = async () => (await page.getByRole("alert").getByText(/ms late/).count()) > 0;
const whileRunning = async (what, condition) => {
  await until(what, async () => (await hasStarved()) || condition());
  assert.equal(await hasStarved(), false, "starved");
};
const passed = () =>
  unlessStarved(async () => {
    await run();
    await whileRunning("the path was passed", () => page.getByText(/The path was passed in/).count());
  });
const status = async () => (await bench.call("path.status")).paths[0];
const isHeld = () => whileRunning("it is held", async () => (await status())?.held && (await status()).factor_now === 0);
const hold = async () => {
  await run();
  await whileRunning("the hold is offered", () => button(page, "Feed hold").count());
  await button(page, "Feed hold").click({ timeout: 5000 }).catch(() => {});
  await isHeld();
  await whileRunning("going on is offered", () => button(page, "Resume").count());
};
const position = async (name) => (await bench.state(name)).position;
const near = async (name, wanted) => {
  const is = await position(name);
  assert.ok(Math.abs(is - wanted) < 0.05, `${name} is at ${is}, not at ${wanted}`);
};

describe("a path on the page", () => {
  beforeEach(async () => {
    bench = await Bench.create();
    await show();
  });
  afterEach(async () => {
    assert.deepEqual(page.complaints, []);
    await page.context().close();
    await bench.end();
  });

  it("is drawn when its file is dropped, and passed to its end", async () => {
    await drop("square.ngc", square);
    await page.getByText(/^Length 30, time .* 3 legs$/).waitFor();
    const points = await page.locator("polyline.way").getAttribute("points");
    const corners = points.split(" ").map((point) => point.split(",").map(Number));
    assert.equal(Math.max(...corners.map(([x]) => Math.round(x))), 10);
    assert.equal(Math.min(...corners.map(([, y]) => Math.round(y))), -10);
    assert.equal(await position("x"), 0, "a dry run moves nothing");
    await page.getByRole("rowheader", { name: "velocity", exact: true }).waitFor();
    await passed();
    await near("x", 0);
    await near("y", 10);
    await until("the tool is where the axes are", async () =>
      Math.abs(Number(await page.locator("circle.tool").getAttribute("cy")) + 10) < 0.1);
    assert.ok(await button(page, "Run").isDisabled(), "a plan is run once");
    assert.equal(await page.locator("circle.farthest").count(), 1);
    assert.ok((await page.locator("path.seen").getAttribute("d")).split("M").length > 5, "dots where they were seen");
  });

  it("is drawn in space, turned by pointer and keys, with the place of the axes", async () => {
    await choose("stairs.ngc", stairs);
    const picture = page.getByRole("img", { name: /^The path in space, by X, Y, Z/ });
    const look = async () => Number(await picture.getAttribute("data-turn")) + 1000 * Number(await picture.getAttribute("data-tilt"));
    // Where the canvas has the colour of the disc that stands for the axes; nothing where it has less than a dot of it.
    const tool = () =>
      picture.evaluate((canvas) => {
        const { data, width } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        const wanted = getComputedStyle(canvas).fill.match(/\d+/g).map(Number);
        let [count, x, y] = [0, 0, 0];
        for (let at = 0; at < data.length; at += 4) {
          if (data[at + 3] < 255 || wanted.some((part, index) => Math.abs(data[at + index] - part) > 2)) continue;
          [count, x, y] = [count + 1, x + ((at / 4) % width), y + Math.floor(at / 4 / width)];
        }
        return count > 20 ? [x / count, y / count] : null;
      });
    const before = await until("the place of the axes", tool);
    await bench.call("axis.move_to", { axis: "z", position: 8 });
    const risen = await until("the place follows", async () => {
      const now = await tool();
      return now && before[1] - now[1] > 20 && now;
    });
    assert.ok(Math.abs(risen[0] - before[0]) < 2, "z goes up in the picture, and not aside");
    await bench.stands("z");

    const first = await look();
    await page.getByRole("group", { name: /the arrow keys turn it/ }).focus();
    await page.keyboard.press("ArrowRight");
    await until("it is turned by a key", async () => (await look()) - first === 5);
    await page.keyboard.press("ArrowUp");
    await until("it is tilted by a key", async () => (await look()) - first === 5005);
    for (let presses = 0; presses < 20; ++presses) await page.keyboard.press("ArrowUp");
    await until("from above at most", async () => (await picture.getAttribute("data-tilt")) === "90");
    const fromAbove = await until("the place of the axes from above", tool);
    const beforeDrag = await look();
    const { x, y } = await picture.boundingBox();
    await page.mouse.move(x + 60, y + 60);
    await page.mouse.down();
    await page.mouse.move(x + 160, y + 60, { steps: 5 });
    await page.mouse.up();
    await until("it is turned by the pointer", async () => (await look()) - beforeDrag >= 40);
    await until("the place has turned with it", async () => {
      const now = await tool();
      return now && Math.hypot(now[0] - fromAbove[0], now[1] - fromAbove[1]) > 20;
    });
    const turned = await look();
    await page.mouse.move(x + 60, y + 60);
    assert.equal(await look(), turned, "a pointer that is not down turns nothing");
    await button(page, "Turn it back").click();
    await until("it is as it was", async () => (await look()) === first);
  });

  it("stands when it is held, goes on, faster, and ends when it is stopped", async () => {
    await choose("long.ngc", longWay);
    await unlessStarved(async () => {
      await hold();
      const where = await position("x");
      assert.ok(where < 150);
      await page.getByRole("slider").fill("200", { timeout: 5000 });
      await whileRunning("the override", async () => (await status())?.factor === 2);
      // The axis may have braked for the last microsteps meanwhile.
      await near("x", where);
      await button(page, "Resume").click({ timeout: 5000 });
      await whileRunning("it goes on", async () => (await position("x")) > where + 1);
    });
    await button(page, "Stop all").click();
    await until("it has ended", async () => (await status()) === undefined);
    await page.getByRole("alert").waitFor();
    assert.equal(await page.locator("circle.farthest").count(), 1, "also of a path that has ended early");
    await bench.stands("x");
    assert.ok((await position("x")) < 150);
  });

  it("is told with the number of a bad line, and moves nothing", async () => {
    await choose("bad.ngc", "G1 X1 F60\nG99\n");
    await page.getByText(/^Line 2, column 1: /).waitFor();
    assert.ok(await button(page, "Run").isDisabled());
    assert.equal(await page.locator("polyline").count(), 0);
  });

  it("is not sent where its file is too large", async () => {
    await page.getByLabel("Path file").waitFor();
    await page.evaluate(() => (File.prototype.arrayBuffer = () => (document.title = "read")));
    await drop("large.ngc", "G1 X1\n".repeat(3_000_000));
    await page.getByText("large.ngc has 18.0 MB, and tmcld takes 16.8 MB: it was not read").waitFor();
    assert.equal(await page.title(), "tmcld");
    assert.equal(await button(page, "Dry run").count(), 0);
  });

  it("shows the name of a file as text", async () => {
    await drop(html, square);
    await page.locator("strong").getByText(html).waitFor();
    await passed();
    assert.equal(await page.title(), "tmcld");
    assert.equal(await page.locator("img").count(), 0);
  });

  it("takes the axes that a person chooses where the file has other names", async () => {
    await choose("table.csv", elsewhere);
    await page.getByLabel("a of the file is").selectOption("z");
    await button(page, "Dry run").click();
    await page.getByLabel("b of the file is").selectOption("y");
    await button(page, "Dry run").click();
    await passed();
    await near("z", 4);
    await near("y", 3);
  });

  it("runs nothing that was planned with other settings", async () => {
    await choose("square.ngc", square);
    await until("it may be run", () => button(page, "Run").isEnabled());
    await page.getByLabel("Tolerance").fill("0.2");
    assert.ok(await button(page, "Run").isDisabled());
    await page.getByLabel("Tolerance").fill("much");
    await button(page, "Dry run").click();
    await page.getByText("That is no number: much").waitFor();
  });

  it("runs a Mint program on the axes that are chosen", async () => {
    await choose("move.mnt", "SPEED = 9000\nACCEL = 90000\nMOVEA = 5000\nGO\n");
    await page.getByLabel("y", { exact: true }).check();
    await button(page, "Run").click();
    await page.getByText("The program has ended: 1 GO").waitFor();
    assert.equal((await bench.state("y")).position_microsteps, 5000);
  });

  it("can be read by a screen reader, on a phone", async () => {
    await page.context().close();
    await show({ bypassCSP: true, viewport: { width: 360, height: 740 } });
    await choose("long.ngc", longWay);
    await unlessStarved(hold);
    assert.deepEqual(await seriousFindings(page), []);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
  });
});

describe("a path that switches outputs", () => {
  it("is told with what its words switch, and where it waits", async () => {
    bench = await Bench.create({ axes: axis("x", 0) + '[path]\nm3 = "bench:1 output 0 1"\nm5 = "bench:1 output 0 0"\n' });
    await show();
    await choose("words.ngc", "G21 G90\nF1200\nM3\nG1 X1\nM5\nM0\nM3\nG1 X2\nM5\nM2\n");
    const rows = page.getByRole("table", { name: "What is switched on the way" }).locator("tbody tr");
    await rows.first().waitFor();
    const told = await rows.evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.textContent)));
    assert.deepEqual(told, [
      ["M3", "bench:1 output 0 1", "2", "3"],
      ["M5", "bench:1 output 0 0", "2", "5"],
    ]);
    await page.getByText("It waits once at M0 for Resume.").waitFor();
    await page.context().close();
    await bench.end();
  });
});

describe("a guest", () => {
  beforeEach(async () => {
    bench = await Bench.create({ keys: "" });
    await show();
  });
  afterEach(async () => {
    await page.context().close();
    await bench.end();
  });

  it("sees a path that is passed, may stop it, and is offered no run", async () => {
    await signIn(page, await bench.token("observe", "guest"));
    await page.getByText(/To run one takes the role operate/).waitFor();
    const path = page.getByRole("article", { name: "Path long.ngc" });
    const order = { axes: ["x", "y"], text: longWay, name: "long.ngc", period_ms: 500 };
    await until("a path is held", async () => {
      if (!(await status())) bench.call("path.run", order).catch(() => {});
      return bench.call("path.feed", { hold: true }).catch(() => false);
    });
    await path.waitFor();
    assert.deepEqual(await path.getByRole("button").allTextContents(), ["Stop the path"]);
    for (const name of ["Run", "Dry run", "Feed hold"]) assert.equal(await button(page, name).count(), 0);
    assert.equal(await page.locator('input[type="file"]').count(), 0);
    await button(path, "Stop the path").click();
    await until("it has ended", async () => (await status()) === undefined);
    assert.ok((await position("x")) < 150);
  });
});
