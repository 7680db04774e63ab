// The page as people use it: a browser, a tmcld, and simulated modules.
import assert from "node:assert/strict";
import { readFile, rename, rm, writeFile } from "node:fs/promises";
import { join } from "node:path";
import { after, afterEach, beforeEach, describe, it } from "node:test";
import { Bench, Cable, button, card, closeBrowser, move, open, seriousFindings, signIn, until } from "./bench.mjs";

let bench;
after(closeBrowser);
afterEach(() => bench.end());

describe("a page that needs no token", () => {
  let page;
  beforeEach(async () => {
    bench = await Bench.create();
    page = await open(bench.url);
  });
  afterEach(async () => {
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  it("shows the axes, and moves one", async () => {
    const quicken = await bench.slow("x");
    await move(page, "x", "100");
    await card(page, "x").getByText("Arrives in").waitFor();
    await card(page, "x").getByText("100 mm").first().waitFor();
    await quicken();
    await bench.stands("x");
    assert.equal((await bench.state("x")).target, 100);
    await card(page, "x").getByText("Arrives in").waitFor({ state: "detached" });
  });

  it("says what was wrong with a wish", async () => {
    await move(page, "x", "far away");
    await card(page, "x").getByRole("alert").waitFor();
    await move(page, "x", "500");
    await card(page, "x").getByText(/soft limit/).waitFor();
    assert.equal((await bench.state("x")).target, 0);
  });

  for (const [how, press] of [
    ["button", (page) => button(page, "Stop all").click()],
    ["space bar", (page) => page.keyboard.press("Space")],
    ["space bar, with the focus in a field", (page) => card(page, "y").getByRole("textbox").press("Space")],
    ["space bar, with the focus on a button", (page) => button(card(page, "y"), "Move").press("Space")],
  ]) {
    it(`stops all by the ${how}, and says when every axis stood`, async () => {
      for (const name of ["x", "y", "z"]) {
        await bench.slow(name);
        await move(page, name, "150");
      }
      for (const name of ["x", "y", "z"]) await bench.moves(name);
      await press(page);
      await page.getByText("All stand: x, y, z").waitFor();
      for (const name of ["x", "y", "z"]) {
        const state = await bench.state(name);
        assert.equal(state.moving, false);
        assert.notEqual(state.position, 150);
      }
    });
  }

  it("says in red which axis did not stop", async () => {
    await bench.state("x");
    await bench.simulator.process.kill("SIGSTOP");
    await button(page, "Stop all").click();
    await page.getByText(/did not stop/).first().waitFor();
    await bench.simulator.process.kill("SIGCONT");
    await page.getByText(/All stand/).waitFor();
  });

  it("says in red that tmcld cannot be reached, and stops all when it can", async () => {
    await bench.slow("x");
    await move(page, "x", "150");
    await bench.moves("x");
    await bench.daemon.end("SIGKILL");
    await page.keyboard.press("Space");
    await page.getByText("all axes did not stop: tmcld cannot be reached").waitFor();
    await bench.startDaemon();
    await page.getByText(/All stand/).waitFor();
    await bench.stands("x");
  });

  it("stops all while its other scripts hang", async () => {
    await bench.slow("x");
    await move(page, "x", "150");
    await bench.moves("x");
    const other = await open(bench.url);
    await button(other, "Stop all").waitFor();
    const blocked = page.evaluate(() => {
      const ends = Date.now() + 3000;
      while (Date.now() < ends);
    });
    await other.keyboard.press("Space");
    await bench.stands("x");
    await blocked;
    await other.context().close();
  });

  it("makes a step when a jog button is tapped", async () => {
    await page.getByLabel("10", { exact: true }).check();
    await page.getByRole("button", { name: /^x by \+10 mm/ }).click();
    await until("the target", async () => (await bench.state("x")).target === 10);
    await bench.stands("x");
  });

  it("is used with the keyboard alone", async () => {
    const focused = () => page.evaluate(() => document.activeElement.getAttribute("aria-label") ?? document.activeElement.textContent);
    const tabTo = async (name) => {
      for (let i = 0; i < 50 && !(await focused()).startsWith(name); ++i) await page.keyboard.press("Tab");
      assert.ok((await focused()).startsWith(name), name);
    };
    await card(page, "x").waitFor();
    await tabTo("Where to move x");
    await page.keyboard.type("7");
    await page.keyboard.press("Enter");
    await until("the target", async () => (await bench.state("x")).target === 7);
    await bench.stands("x");
    await tabTo("x by +");
    await page.keyboard.down("Enter");
    await bench.moves("x");
    await until("a hold", async () => (await bench.state("x")).lease !== null);
    await page.keyboard.up("Enter");
    await bench.stands("x");
    await tabTo("Stop y");
  });

  it("can be read by a screen reader", async () => {
    const reader = await open(bench.url, { bypassCSP: true });
    await card(reader, "x").waitFor();
    assert.deepEqual(await seriousFindings(reader), []);
    await reader.context().close();
  });

  it("tells the numbers that tmclctl tells", async () => {
    await bench.call("axis.move_to", { axis: "z", position: -3.25 });
    await card(page, "z").getByText("-3.25 mm").first().waitFor();
    await bench.stands("z");
  });

  it("lets a module that has started again move when a person has looked", async () => {
    await bench.call("module.reset", { bus: "bench", address: 1 });
    await button(card(page, "x"), "Recover").click();
    await until("the latch is open", async () => !(await bench.state("x")).latched);
  });

  it("comes back by itself when tmcld does", async () => {
    await button(page, "Stop all").waitFor();
    await bench.daemon.end();
    await page.getByText("Connecting ...").waitFor();
    await bench.startDaemon();
    await page.getByText("Connecting ...").waitFor({ state: "detached" });
    await move(page, "x", "3");
    await until("the target", async () => (await bench.state("x")).target === 3);
  });

  it("says that the connection is lost when tmcld stands still", async () => {
    await button(page, "Stop all").waitFor();
    bench.daemon.process.kill("SIGSTOP");
    await page.getByText("Connecting ...").waitFor();
    bench.daemon.process.kill("SIGCONT");
    await page.getByText("Connecting ...").waitFor({ state: "detached" });
  });

  it("goes on a phone without scrolling sideways", async () => {
    await page.setViewportSize({ width: 360, height: 640 });
    await card(page, "x").waitFor();
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
    assert.ok(await button(page, "Stop all").isVisible());
  });
});

describe("the scope", () => {
  let page;
  const linesOf = (text) => text.trim().split("\n");
  const trace = async (value) => {
    const scope = page.getByRole("region", { name: "Scope" });
    await scope.getByLabel("Value").fill(value);
    await button(scope, "Add").click();
  };
  const saved = async () => {
    const [download] = await Promise.all([page.waitForEvent("download"), button(page, "Save CSV").click()]);
    return linesOf(await readFile(await download.path(), "utf8"));
  };
  // What would be saved. Chromium refuses a page that saves more than ten files in a row, and says nothing.
  const recorded = async () =>
    linesOf(
      await button(page, "Save CSV").evaluate((save) => {
        const [{ createObjectURL }, { click }] = [URL, HTMLAnchorElement.prototype];
        let text;
        URL.createObjectURL = (file) => ((text = file.text()), "");
        HTMLAnchorElement.prototype.click = () => {};
        save.click();
        URL.createObjectURL = createObjectURL;
        HTMLAnchorElement.prototype.click = click;
        return text;
      }),
    );
  beforeEach(async () => {
    bench = await Bench.create();
    page = await open(bench.url);
    await card(page, "x").waitFor();
  });
  afterEach(async () => {
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  it("draws values and parameters, and saves them", async () => {
    for (const value of ["position", "velocity", "actual_acceleration"]) await trace(value);
    await page.locator(".plot canvas").waitFor();
    await move(page, "x", "5");
    await bench.stands("x");
    await until("the end of the move is recorded", async () => (await recorded()).at(-1).split(",")[1] === "5");
    const [titles, ...rows] = await saved();
    assert.equal(titles, '"Time in s","x position (mm)","x velocity (mm/s)","x actual_acceleration (actual_acceleration)"');
    assert.ok(rows.some((row) => Number(row.split(",")[2]) > 1), "it was seen moving");
    const times = rows.map((row) => Number(row.split(",")[0]));
    assert.deepEqual(times, [...times].sort((a, b) => a - b));
  });

  it("stands still while it is paused", async () => {
    await trace("position");
    await until("rows", async () => (await recorded()).length > 3);
    await button(page, "Pause").click();
    const rows = await recorded();
    await move(page, "x", "3");
    await bench.stands("x");
    assert.deepEqual(await recorded(), rows);
  });

  it("holds the picture half a window after a value has passed a level", async () => {
    await trace("position");
    await page.getByLabel("Show the last").selectOption("5");
    await page.getByLabel("level").fill("2,5");
    await button(page, "Arm").click();
    await page.getByText("It waits for that.").waitFor();
    await move(page, "x", "5");
    await page.getByText(/^Held: it happened at/).waitFor();
    const rows = (await recorded()).slice(1).map((row) => row.split(",").map(Number));
    const fired = rows.findIndex(([, position]) => position >= 2.5);
    assert.ok(fired > 0 && rows[fired - 1][1] < 2.5);
    assert.ok(rows.at(-1)[0] - rows[fired][0] >= 2.5);
    await button(page, "Go on").waitFor();
  });

  it("tells the difference between two cursors", async () => {
    await trace("position");
    await move(page, "x", "5");
    await until("the end of the move is recorded", async () => (await recorded()).at(-1).split(",")[1] === "5");
    assert.equal(await page.getByLabel("Cursor A at").count(), 0);
    await button(page, "Pause").click();
    const rows = (await recorded()).slice(1).map((row) => row.split(",").map(Number));
    for (const [name, at] of [["A", rows[1][0]], ["B", rows.at(-1)[0]]]) {
      await page.getByLabel(`Cursor ${name} at`).fill(String(at));
      await page.keyboard.press("Enter");
    }
    const table = page.getByRole("group", { name: "Cursors" });
    const difference = (label) => table.getByRole("row", { name: label }).locator("td").last().textContent();
    assert.equal(Number(await difference(/^x position/)), Number((5 - rows[1][1]).toFixed(4)));
    assert.equal(Number(await difference(/^Time in s/)), Number((rows.at(-1)[0] - rows[1][0]).toFixed(4)));
    await page.locator(".plot .u-over").first().click({ position: { x: 20, y: 20 } });
    assert.equal(await page.getByLabel("Cursor B at").inputValue(), "");
  });

  it("shows ahead of now what the twin of an axis will do, and beneath how far it is off that", async () => {
    await trace("position");
    const differences = page.locator(".plot .uplot").nth(1);
    // How often a line in the colour of the trace begins, from left to right: a dotted one does so again and again.
    const pieces = () =>
      page.locator(".plot canvas").first().evaluate((canvas) => {
        const { data, width, height } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        const isLine = (at) => [0x2f, 0x9e, 0x6e].every((part, byte) => Math.abs(data[at + byte] - part) < 60) && data[at + 3] > 128;
        let [count, was] = [0, false];
        for (let x = 0; x < width; ++x) {
          let is = false;
          for (let y = 0; y < height; ++y) is ||= isLine(4 * (y * width + x));
          if (is && !was) ++count;
          was = is;
        }
        return count;
      });
    await until("rows", async () => (await recorded()).length > 50);
    assert.equal(await differences.count(), 0);
    // Half a minute, also for a busy machine. What was set right before the move counts.
    await bench.call("parameter.set", { axis: "x", parameter: "max_velocity", value: 300 });
    await bench.call("axis.move_to", { axis: "x", position: 60 });
    await differences.waitFor();
    await until("a dotted line", async () => (await pieces()) > 15);
    assert.ok((await bench.state("x")).moving, "what is to come is shown before it has come");
    await bench.stands("x");
    await until("nothing is ahead", async () => (await pieces()) < 5);
    // Where the pointer is, the value is told.
    const { width } = await differences.locator(".u-over").boundingBox();
    const told = () => differences.locator(".u-legend .u-value").nth(1).textContent();
    await until("a difference", async () => {
      for (let x = 5; x < width; x += 20) {
        await differences.locator(".u-over").hover({ position: { x, y: 20 } });
        if (/\d/.test(await told())) return true;
      }
      return false;
    });
    assert.ok(Math.abs(Number((await told()).replace("\u2212", "-"))) < 2, `${await told()} of 60 mm`);

    await button(page, "Forecast").click();
    await until("no differences", async () => (await differences.count()) === 0);
    await bench.slow("x");
    await move(page, "x", "0");
    await bench.moves("x");
    const rows = (await recorded()).length;
    await until("rows of the move", async () => (await recorded()).length > rows + 100);
    assert.equal(await differences.count(), 0);
  });

  it("says which parameter there is not", async () => {
    await trace("no_such_thing");
    await page.getByRole("alert").getByText(/no_such_thing/).waitFor();
  });

  it("is in the address as it was set up, and comes back with tmcld", async () => {
    await trace("position");
    await trace("load_value");
    const other = await open(page.url());
    await button(other, "Remove x load_value").waitFor();
    await other.context().close();
    await bench.daemon.end();
    await bench.startDaemon();
    await page.getByText("Connecting ...").waitFor({ state: "detached" });
    await until("rows", async () => (await recorded()).length > 3);
  });
});

describe("a jog", () => {
  let page, cable;
  beforeEach(async () => {
    bench = await Bench.create({ keys: "" });
    cable = await Cable.to(bench.port);
    page = await open(cable.url);
    await signIn(page, await bench.token("operate", "lab"));
    const jog = page.getByRole("button", { name: /^x by \+/ });
    await jog.scrollIntoViewIfNeeded();
    const box = await jog.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await bench.moves("x");
  });
  afterEach(() => cable.end());
  const hasEnded = async () => {
    await bench.stands("x");
    await until("its lease is given back", async () => (await bench.state("x")).lease === null);
    const { position } = await bench.state("x");
    assert.ok(position > 0 && position < 200);
  };

  it("goes on for as long as the button is held", async () => {
    await until("a long way", async () => (await bench.state("x")).position > 5);
    assert.ok((await bench.state("x")).moving);
    await page.mouse.up();
    await hasEnded();
    await page.context().close();
  });

  it("ends when the page is closed", async () => {
    await page.context().close();
    await hasEnded();
  });

  it("ends when the network is gone", async () => {
    cable.cut();
    await hasEnded();
    await page.getByText("Connecting ...").waitFor();
    await page.context().close();
  });

  it("ends when its tab stands still", async () => {
    const session = await page.context().newCDPSession(page);
    await session.send("Debugger.enable");
    await session.send("Debugger.pause");
    await hasEnded();
    await session.send("Debugger.resume").catch(() => {});
    await page.context().close();
  });

  it("ends when the browser loses the window", async () => {
    await page.evaluate(() => window.dispatchEvent(new Event("blur")));
    await hasEnded();
    await page.context().close();
  });

  it("ends when its tab is hidden", async () => {
    await page.evaluate(() => document.dispatchEvent(new Event("visibilitychange", { bubbles: true })));
    await hasEnded();
    await page.context().close();
  });

  it("ends when tmcld is killed", async () => {
    await bench.daemon.end("SIGKILL");
    await page.context().close();
    await bench.startDaemon();
    await hasEnded();
  });
});

describe("who is who", () => {
  beforeEach(async () => {
    bench = await Bench.create({ keys: "" });
  });

  it("may stop where it has no role", async () => {
    await bench.end();
    bench = await Bench.create({ keys: 'loopback_without_token = true\n[[access]]\nrole = "configure"\nusers = ["root"]' });
    const page = await open(bench.url);
    await page.getByText(/may stop axes, and nothing else/).waitFor();
    assert.deepEqual(await page.getByRole("button").allTextContents(), ["Stop all"]);
    await bench.slow("x");
    await bench.call("axis.move_to", { axis: "x", position: 150 });
    await bench.moves("x");
    await page.keyboard.press("Space");
    await bench.stands("x");
    await page.context().close();
  });

  it("is let in once by the link for a phone", async () => {
    await bench.token("operate", "phone");
    const { code } = await bench.call("token.invite", { name: "phone" });
    const page = await open(`${bench.url}/#code=${code}`);
    await card(page, "x").waitFor();
    await page.getByText("phone · operate").waitFor();
    assert.equal(page.url().includes(code), false);
    await page.context().close();
    const other = await open(`${bench.url}/#code=${code}`);
    await other.getByText(/has been used, or is too old/).waitFor();
    await signIn(other, await bench.token("operate", "lab"));
    await card(other, "x").waitFor();
    await other.context().close();
  });

  it("has no button before the sign-in, and takes no wrong token", async () => {
    const page = await open(bench.url);
    await page.getByLabel("Token").waitFor();
    assert.equal(await button(page, "Stop all").count(), 0);
    await signIn(page, "tmcl_0");
    await page.getByText(/there is no such token/).waitFor();
    await signIn(page, await bench.token("operate", "lab"));
    await move(page, "x", "4");
    await until("the target", async () => (await bench.state("x")).target === 4);
    await page.reload();
    await card(page, "x").waitFor();
    assert.equal(await page.evaluate(() => document.cookie), "");
    await button(page, "Sign out").click();
    await page.getByLabel("Token").waitFor();
    await page.context().close();
  });

  it("offers a guest to look, to draw and to stop, and nothing else", async () => {
    const page = await open(bench.url);
    await signIn(page, await bench.token("observe", "guest"));
    await card(page, "x").getByText("0 mm").first().waitFor();
    const offered = await page.locator("button:not(.tabs button)").allTextContents();
    assert.deepEqual(offered, ["Sign out", "Stop all", "Stop", "Stop", "Stop", "Add"]);
    assert.equal(await card(page, "x").getByRole("textbox").count(), 0);
    await bench.slow("x");
    await bench.call("axis.move_to", { axis: "x", position: 150 });
    await bench.moves("x");
    await page.keyboard.press("Space");
    await bench.stands("x");
    await page.context().close();
  });

  it("turns the button grey, with the reason, when the token is revoked", async () => {
    const page = await open(bench.url);
    await signIn(page, await bench.token("operate", "lab"));
    await card(page, "x").waitFor();
    await bench.call("token.revoke", { name: "lab" });
    await page.getByText(/This page may do nothing any more: the sign-in has ended/).waitFor();
    assert.ok(await button(page, "Stop all").isDisabled());
    await button(page, "Sign in again").click();
    await page.getByLabel("Token").waitFor();
    await page.context().close();
  });

  it("finds out by the press itself that the sign-in has ended", async () => {
    const page = await open(bench.url);
    await signIn(page, await bench.token("operate", "lab"));
    await card(page, "x").waitFor();
    await page.context().clearCookies();
    await page.keyboard.press("Space");
    await page.getByText(/This page may do nothing any more/).waitFor();
    await page.context().close();
  });

  it("takes no cookie of a page from elsewhere", async () => {
    const page = await open(bench.url);
    await signIn(page, await bench.token("operate", "lab"));
    await card(page, "x").waitFor();
    const [cookie] = await page.context().cookies();
    assert.deepEqual([cookie.httpOnly, cookie.sameSite], [true, "Strict"]);
    const body = JSON.stringify({ jsonrpc: "2.0", id: 1, method: "axis.move_to", params: { axis: "x", position: 50 } });
    const headers = { "Content-Type": "application/json", Cookie: `${cookie.name}=${cookie.value}` };
    for (const origin of ["http://localhost:1", "http://evil.example", "null"]) {
      const answer = await fetch(`${bench.url}/rpc`, { method: "POST", body, headers: { ...headers, Origin: origin } });
      assert.equal(answer.status, 403, origin);
    }
    assert.equal((await bench.state("x")).target, 0);
    await page.context().close();
  });
});

describe("a page that is open while tmcld is updated", () => {
  /** As another build would: the script has another name. */
  const update = async () => {
    const folder = join(bench.folder, "page");
    const index = await readFile(join(folder, "index.html"), "utf8");
    const [, script] = index.match(/assets\/(index-[^"]+\.js)/);
    for (const coding of ["", ".gz", ".br"]) await rename(join(folder, "assets", script + coding), join(folder, "assets", "index-new.js" + coding));
    await writeFile(join(folder, "index.html"), index.replace(script, "index-new.js"));
    for (const coding of [".gz", ".br"]) await rm(join(folder, "index.html" + coding));
  };

  it("is reloaded", async () => {
    bench = await Bench.create({ hasOwnPage: true });
    const page = await open(bench.url);
    await card(page, "x").waitFor();
    await bench.daemon.end();
    await update();
    await bench.startDaemon();
    await page.locator('script[src="/assets/index-new.js"]').waitFor({ state: "attached" });
    await card(page, "x").waitFor();
    await page.context().close();
  });

  it("is reloaded once, and says then that it did not help", async () => {
    bench = await Bench.create();
    const page = await open(bench.url);
    await card(page, "x").waitFor();
    let loads = 0;
    page.on("load", () => ++loads);
    const restart = async () => {
      await bench.daemon.end();
      await bench.startDaemon();
    };
    // Only a page that asks what there is is told of another one, as by a cache in between.
    await page.route(bench.url + "/", (route) =>
      route.request().isNavigationRequest() ? route.continue() : route.fulfill({ body: "another", contentType: "text/html" }),
    );
    await restart();
    await until("it is loaded again", () => loads === 1);
    await card(page, "x").waitFor();
    await restart();
    await page.getByText(/reloading has not brought it/).waitFor();
    assert.equal(loads, 1);
    await page.context().close();
  });
});

describe("what comes from others", () => {
  const html = '<img src="x" onerror="document.title = 1">';

  it("is text, whatever it looks like", async () => {
    bench = await Bench.create();
    const page = await open("about:blank");
    const title = async () => assert.equal(await page.title(), "tmcld");
    // tmcld takes no such name itself.
    await page.routeWebSocket("**/ws", (socket) => {
      const tmcld = socket.connectToServer();
      tmcld.onMessage((text) => socket.send(text.replaceAll('"x"', JSON.stringify(html)).replaceAll('"mm"', JSON.stringify(html))));
    });
    await page.goto(bench.url);
    await page.getByRole("heading", { name: html }).waitFor();
    await title();
    await page.route("**/rpc", (route) =>
      route.fulfill({ json: { jsonrpc: "2.0", id: 1, error: { code: -32000, message: html, data: { name: html, hint: html } } } }),
    );
    await button(card(page, "y"), "Stop y").click();
    await card(page, "y").getByRole("alert").getByText(html).waitFor();
    await page.keyboard.press("Space");
    await page.getByText(`all axes did not stop: ${html}`).waitFor();
    await title();
    assert.equal(await page.locator("img").count(), 0);
    assert.deepEqual(page.complaints, []);
    await page.context().close();
  });

  it("shows the page in no frame", async () => {
    bench = await Bench.create();
    const page = await open(bench.url);
    const answer = await page.request.get(bench.url);
    assert.match(answer.headers()["content-security-policy"], /frame-ancestors 'none'/);
    assert.equal(answer.headers()["x-content-type-options"], "nosniff");
    assert.equal(answer.headers()["cache-control"], "no-cache");
    await page.context().close();
  });
});
