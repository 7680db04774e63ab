// The page of a fleet: a browser, a broker that serves the page, and gateways.
import assert from "node:assert/strict";
import { join } from "node:path";
import { after, afterEach, before, beforeEach, describe, it } from "node:test";
import { Bench, button, closeBrowser, open, seriousFindings, until } from "./bench.mjs";
import { Broker, Gateway, password } from "./fleet_bench.mjs";
import { looksLike, skip } from "./looks.mjs";

let broker, page;
before(async () => {
  broker = await Broker.create();
});
after(async () => {
  await closeBrowser();
  await broker.end();
});
afterEach(async () => {
  assert.deepEqual(page.complaints, []);
  await page.context().close();
});

const field = (name) => page.getByLabel(name, { exact: true });
const gatewayRow = (name) => page.locator(`[data-gateway="${name}"]`);
const axisRow = (gateway, axis) => page.locator(`[data-axis="${gateway}/${axis}"]`);
const report = (scope = "all") => page.locator(`[data-run="${scope}"]`);

async function signIn(user = "anna", words = password) {
  await field("User name").fill(user);
  await field("Password").fill(words);
  await button(page, "Connect").click();
}
async function show(query = "", options = {}) {
  page = await open(broker.url + query, { ignoreHTTPSErrors: true, ...options });
  await signIn();
  await button(page, "Disconnect").waitFor();
}
const counts = (text) => page.locator("[data-count=gateways]").getByText(text, { exact: true }).waitFor();

describe("the page of a fleet with two gateways", () => {
  let gateways, one, other;
  before(async () => {
    gateways = [await Gateway.create(broker, "hall3-1"), await Gateway.create(broker, "hall3-2")];
    [one, other] = gateways;
    for (const { bench } of gateways) for (const name of ["x", "y"]) await bench.slow(name);
  });
  after(async () => {
    for (const gateway of gateways) await gateway.end();
    const chaos = await broker.publisher();
    for (const { name } of gateways) await chaos.say(`tmcl/v1/${name}/birth`, "");
    chaos.end();
  });
  beforeEach(async () => {
    for (const { bench } of gateways) await bench.call("system.stop_all");
    await allStand();
  });
  /** Again, where the computer was so busy that tmcld stood still meanwhile. */
  const moveTo = (bench, axis, position) =>
    until(`${axis} is to move`, () =>
      bench.call("axis.move_to", { axis, position }).then(
        () => true,
        (error) => assert.match(error.message, /stood still/),
      ),
    );
  const setOut = async () => {
    for (const { bench } of gateways)
      for (const axis of ["x", "y"]) {
        const { position } = await bench.state(axis);
        await moveTo(bench, axis, position < 0 ? 190 : -190);
        await bench.moves(axis);
      }
  };
  const allStand = async () => {
    for (const { bench } of gateways) for (const name of ["x", "y"]) await bench.stands(name);
  };

  it("is given by the broker, and shows what moves", async () => {
    await show();
    await counts("2 gateways: 2 online, 0 away");
    await axisRow("hall3-1", "x").getByText("stands").waitFor();
    const { position } = await one.bench.state("x");
    one.tmclctl("move", "x", `${position > 0 ? position - 1 : position + 1}mm`);
    await axisRow("hall3-1", "x").getByText("moves").waitFor();
    // On the way only telemetry tells where it is, and that comes as the page wishes for it.
    const seen = new Set();
    await until("places on the way", async () => seen.add(await axisRow("hall3-1", "x").getByRole("cell").first().textContent()).size > 3);
    await one.bench.stands("x");
    const there = (await one.bench.state("x")).position;
    await axisRow("hall3-1", "x").getByText(`${Number(there.toFixed(4))} mm`).waitFor();
  });

  it("has the broker and the user in its address, and the password nowhere", async () => {
    await show("&gateways=hall3-2");
    await gatewayRow("hall3-2").waitFor();
    assert.equal(await gatewayRow("hall3-1").count(), 0);
    const address = new URL(page.url());
    assert.equal(address.searchParams.get("user"), "anna");
    assert.equal(address.searchParams.get("broker"), broker.address);
    const kept = await page.evaluate(() => JSON.stringify([location.href, { ...localStorage }, { ...sessionStorage }, document.cookie]));
    assert.ok(!kept.includes("secret"), kept);
    await page.reload();
    assert.equal(await field("User name").inputValue(), "anna");
    assert.equal(await field("Password").inputValue(), "");
  });

  it("shows the gateways whose names fit", async () => {
    await show();
    await gatewayRow("hall3-1").waitFor();
    await field("Gateways").fill("*-2");
    await gatewayRow("hall3-1").waitFor({ state: "detached" });
    await gatewayRow("hall3-2").waitFor();
    await field("Gateways").fill("hall4-*");
    await page.getByText("No gateway has such a name.").waitFor();
  });

  it("says why the broker does not let it in", async () => {
    page = await open(broker.url, { ignoreHTTPSErrors: true });
    await signIn("anna", "wrong");
    await page.getByRole("alert").getByText(/refuses the connection/).waitFor();
    await signIn("an/na");
    await page.getByRole("alert").getByText(/A user name has/).waitFor();
    await field("Address of the broker").fill("https://localhost/");
    await signIn();
    await page.getByRole("alert").getByText(/That is no address/).waitFor();
    await field("Address of the broker").fill("wss://localhost:1/");
    await signIn();
    await page.getByRole("alert").getByText(/cannot be reached/).waitFor();
  });

  for (const [how, press] of [
    ["button", () => button(page, "Stop all").click()],
    ["space bar", () => page.keyboard.press("Space")],
    ["space bar, with the focus in a field", () => field("Gateways").press("Space")],
  ]) {
    it(`stops all by the ${how}, and says which have confirmed`, async () => {
      await show();
      await counts("2 gateways: 2 online, 0 away");
      await setOut();
      await press();
      await report().getByText("Stopped: 6 axes of 2 gateways").waitFor();
      await allStand();
      for (const { name } of gateways) await gatewayRow(name).getByText("stop confirmed").waitFor();
      await axisRow("hall3-2", "y").getByText("stop confirmed").waitFor();
    });
  }

  it("stops one gateway, and no other", async () => {
    await show();
    await gatewayRow("hall3-2").waitFor();
    await setOut();
    await button(page, "Stop hall3-2").click();
    await report("hall3-2").getByText(/Stopped: 3 axes of 1 gateway/).waitFor();
    for (const name of ["x", "y"]) await other.bench.stands(name);
    assert.ok((await one.bench.state("x")).moving);
    await button(page, "Stop all").click();
    await report().getByText(/Stopped/).waitFor();
    await allStand();
  });

  it("names in red what does not answer, and stops it when it does", async () => {
    await show();
    await counts("2 gateways: 2 online, 0 away");
    await setOut();
    other.mqtt.process.kill("SIGSTOP");
    await button(page, "Stop all").click();
    await report().locator(".problem").getByText(/^hall3-2: no answer/).waitFor();
    await gatewayRow("hall3-1").getByText("stop confirmed").waitFor();
    await gatewayRow("hall3-2").locator(".problem").getByText("stop not confirmed").waitFor();
    for (const name of ["x", "y"]) await one.bench.stands(name);
    other.mqtt.process.kill("SIGCONT");
    for (const name of ["x", "y"]) await other.bench.stands(name);
    // Where the test was slow the page has given up: another press is answered.
    await button(page, "Stop all").click();
    await report().getByText("Stopped: 6 axes of 2 gateways").waitFor();
  });

  it("says which module did not confirm", async () => {
    await show();
    await counts("2 gateways: 2 online, 0 away");
    await other.bench.simulator.process.kill("SIGSTOP");
    await button(page, "Stop all").click();
    await report().locator(".problem").getByText(/^hall3-2 [xy]: /).first().waitFor();
    await other.bench.simulator.process.kill("SIGCONT");
    await button(page, "Stop all").click();
    await report().getByText("Stopped: 6 axes of 2 gateways").waitFor();
  });

  it("says when tmcld of a gateway is gone, and when it is back", async () => {
    await show();
    await counts("2 gateways: 2 online, 0 away");
    await other.bench.daemon.end();
    await counts("2 gateways: 1 online, 0 away, 1 without tmcld");
    await gatewayRow("hall3-2").getByText("without tmcld").waitFor();
    await button(page, "Stop all").click();
    await report().locator(".problem").getByText(/^hall3-2: tmcld is not there/).waitFor();
    await other.bench.startDaemon();
    await counts("2 gateways: 2 online, 0 away");
  });

  it("shows a gateway that is killed as away, and waits for no answer of it", async () => {
    await show();
    await counts("2 gateways: 2 online, 0 away");
    await other.mqtt.end("SIGKILL");
    await counts("2 gateways: 1 online, 1 away");
    await gatewayRow("hall3-2").locator(".problem").getByText("away").waitFor();
    await button(page, "Stop all").click();
    await report().getByText("Stopped: 3 axes of 1 gateway").waitFor();
    await report().getByText(/^1 gateway away: a stop does not reach/).waitFor();
    await other.start();
    await counts("2 gateways: 2 online, 0 away");
  });

  it("says loudly that a stop does not go out, and sends it when the broker is back", async () => {
    await show();
    await counts("2 gateways: 2 online, 0 away");
    await broker.program.end("SIGKILL");
    await page.getByRole("alert").getByText(/What is shown is old/).waitFor();
    await setOut();
    await button(page, "Stop all").click();
    await page.getByRole("alert").getByText(/^NOT STOPPED/).waitFor();
    assert.ok((await one.bench.state("x")).moving);
    await broker.start();
    await counts("2 gateways: 2 online, 0 away");
    await button(page, "Stop all").click();
    await report().getByText("Stopped: 6 axes of 2 gateways").waitFor();
    await allStand();
  });

  it("takes its wishes back", async () => {
    await show();
    await gatewayRow("hall3-1").waitFor();
    await until("a wish", () => broker.retained("tmcl/v1/hall3-1/want/anna") !== "");
    await button(page, "Disconnect").click();
    await until("no wish", () => broker.retained("tmcl/v1/hall3-1/want/anna") === "");
  });

  it("can be read by a screen reader", async () => {
    page = await open(broker.url, { ignoreHTTPSErrors: true, bypassCSP: true });
    assert.deepEqual(await seriousFindings(page), []);
    await signIn();
    await axisRow("hall3-2", "y").waitFor();
    await button(page, "Stop all").click();
    await report().getByText(/Stopped/).waitFor();
    assert.deepEqual(await seriousFindings(page), []);
  });

  it("goes on a phone without scrolling sideways", async () => {
    await show("", { viewport: { width: 360, height: 640 } });
    await axisRow("hall3-1", "x").waitFor();
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
    assert.ok(await button(page, "Stop all").isVisible());
  });
});

const birth = (axes, tmcld = "1") => JSON.stringify({ online: true, epoch: "e", nonce_ttl_ms: 2000, tmcld_mqtt: "1", tmcld, axes });
const death = JSON.stringify({ online: false, epoch: "e" });
const state = (more) =>
  JSON.stringify({
    ...{ axis: "x", position_microsteps: 640, velocity_pps: 0, target_microsteps: 0, position: 0.1, velocity: 0, target: 0, unit: "mm" },
    ...{ moving: false, latched: false, referenced: true, unattended: false, stop_cause: null, owner: null, faults: [], ...more },
  });

it("the page of a fleet looks as it did", { skip }, async () => {
  const chaos = await broker.publisher();
  const births = { "hall3-1": birth(["x", "y", "z"]), "hall3-2": birth(["x", "y"]), "hall3-3": death, "hall3-10": birth([], null) };
  for (const [name, text] of Object.entries(births)) await chaos.say(`tmcl/v1/${name}/birth`, text);
  const states = [
    ["hall3-1", { axis: "x", stop_cause: "client", position: 12.5 }],
    ["hall3-1", { axis: "y", owner: "anna by tmcld-mqtt", moving: true, position: -3.25 }],
    ["hall3-1", { axis: "z", unit: null, position: null, referenced: false }],
    ["hall3-2", { axis: "x", faults: ["stall", "overtemperature_warning"], stop_cause: "stall" }],
    ["hall3-2", { axis: "y", latched: true, referenced: false }],
  ];
  for (const [name, more] of states) await chaos.say(`tmcl/v1/${name}/state/${more.axis}`, state(more));
  page = await open("about:blank", { ignoreHTTPSErrors: true, viewport: { width: 1280, height: 800 } });
  await page.clock.install();
  await page.goto(broker.url);
  await signIn();
  await axisRow("hall3-2", "y").getByText("latched").waitFor();
  await axisRow("hall3-1", "y").getByText("moves").waitFor();
  await counts("4 gateways: 2 online, 1 away, 1 without tmcld");
  // From here on time passes by the test: the page does not give up on a slow computer.
  await page.clock.pauseAt(new Date(await page.evaluate(() => Date.now() + 2000)));
  const pass = (ms, condition) => until("what the page draws", async () => (await page.clock.runFor(ms), condition()));
  let id;
  void broker.idOfStop().then((found) => (id = found));
  await button(page, "Stop all").click();
  await pass(20, () => id);
  await chaos.say(`tmcl/v1/reply/anna/hall3-1/${id}`, JSON.stringify({ result: { stopped: ["x", "y", "z"].map((axis) => ({ axis, milliseconds: 3 })), failed: [] } }), false);
  const error = { message: "module 1 does not answer" };
  await chaos.say(`tmcl/v1/reply/anna/hall3-2/${id}`, JSON.stringify({ result: { stopped: [{ axis: "x", milliseconds: 3 }], failed: [{ axis: "y", error }] } }), false);
  await chaos.say(`tmcl/v1/reply/anna/hall3-10/${id}`, JSON.stringify({ error: { message: "tmcld is not there" } }), false);
  const said = report().getByRole("listitem");
  await pass(5, async () => (await gatewayRow("hall3-1").getByText("stop confirmed").count()) > 0 && (await said.allTextContents()).join().includes("not there"));
  await looksLike(page, "fleet", [page.locator(".who")]);
  for (const name of Object.keys(births)) await chaos.say(`tmcl/v1/${name}/birth`, "");
  for (const [name, { axis }] of states) await chaos.say(`tmcl/v1/${name}/state/${axis}`, "");
  chaos.end();
});

describe("the page of a fleet on a broker where anything is written", () => {
  const html = '<img src="x" onerror="document.title = 1">';
  let chaos;
  beforeEach(async () => {
    chaos = await broker.publisher();
    await chaos.say("tmcl/v1/good/birth", birth(["x"]));
    await chaos.say("tmcl/v1/good/state/x", state({}));
    await show();
    await axisRow("good", "x").getByText("0.1 mm").waitFor();
  });
  afterEach(async () => {
    for (const name of ["good", "bad", "worse", "all", "g h", html]) await chaos.say(`tmcl/v1/${name}/birth`, "");
    await chaos.say("tmcl/v1/good/state/x", "");
    chaos.end();
  });

  it("shows gateways, and texts as they are", async () => {
    const births = ["{", "[]", "null", "\u0000", birth([html]), birth("x"), birth(["a/b"]), `{"online":1}`, " ".repeat(1_100_000), "[".repeat(60_000)];
    for (const text of births) await chaos.say("tmcl/v1/bad/birth", text);
    for (const name of ["all", "reply", "g h", html, "x".repeat(100)]) await chaos.say(`tmcl/v1/${name}/birth`, birth(["x"]), false);
    for (const text of ["{", state({ axis: "y" }), state({ position: html }), state({ faults: 7 }), state({ moving: "yes" })]) await chaos.say("tmcl/v1/good/state/x", text);
    await chaos.say("tmcl/v1/good/telemetry/x", '{"position_microsteps":"7"}', false);
    await chaos.say("tmcl/v1/good/state/x", state({ position: 0.2, owner: html, stop_cause: "constructor", faults: ["__proto__", html] }));
    await axisRow("good", "x").getByText("0.2 mm").waitFor();
    assert.deepEqual(await axisRow("good", "x").getByRole("cell").allTextContents(), ["0.2 mm", `stands__proto__${html}`, "constructor", html]);
    await counts("1 gateway: 1 online, 0 away");
    await page.getByText(/messages on the broker were not as gateways write them/).waitFor();
    assert.equal(await page.locator("img").count(), 0);
    assert.equal(await page.title(), "Fleet");
  });

  it("takes no answer to a stop but that of the gateway to this press", async () => {
    await button(page, "Stop all").click();
    await report().getByText(/^good: no answer/).waitFor();
    const stopped = JSON.stringify({ result: { stopped: [{ axis: "x", milliseconds: 1 }], failed: [] }, epoch: "e" });
    for (const to of ["anna/good/000000000000000000000000", "anna/all/7", "eve/good/7", "anna/worse/7"]) await chaos.say(`tmcl/v1/reply/${to}`, stopped, false);
    await chaos.say("tmcl/v1/worse/birth", JSON.stringify({ online: false, epoch: "e" }));
    await gatewayRow("worse").waitFor();
    assert.equal(await report().getByText(/^good: no answer/).count(), 1);
    await gatewayRow("good").locator(".problem").getByText("stop not confirmed").waitFor();
    const id = await broker.idOfStop();
    await chaos.say(`tmcl/v1/reply/anna/good/${id}`, "{", false);
    await chaos.say(`tmcl/v1/reply/anna/good/${id}`, stopped, false);
    await gatewayRow("good").getByText("stop confirmed").waitFor();
  });

  it("goes on where a will of an earlier connection comes late", async () => {
    await chaos.say("tmcl/v1/good/birth", birth(["x"]).replace('"e"', '"f"'));
    await chaos.say("tmcl/v1/good/birth", JSON.stringify({ online: false, epoch: "e" }));
    await chaos.say("tmcl/v1/worse/birth", birth([]));
    await gatewayRow("worse").waitFor();
    await gatewayRow("good").getByText("online").waitFor();
    await chaos.say("tmcl/v1/good/birth", JSON.stringify({ online: false, epoch: "f" }));
    await gatewayRow("good").getByText("away").waitFor();
  });
});

describe("the page of a fleet, as tmcld gives it", () => {
  let bench;
  beforeEach(async () => {
    bench = await Bench.create();
  });
  afterEach(() => bench.end());

  it("is there to be saved, and works as a file", async () => {
    page = await open(`${bench.url}/?broker=${encodeURIComponent(broker.address)}`, { ignoreHTTPSErrors: true });
    await page.waitForURL(/fleet.html/);
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByText("Save it").click()]);
    assert.equal(download.suggestedFilename(), "fleet.html");
    // There it may run no script, and so reaches no broker.
    assert.match(page.complaints.splice(0).join(), /Content Security Policy/);
    const file = join(bench.folder, "fleet.html");
    await download.saveAs(file);
    await page.goto(`file://${file}?broker=${encodeURIComponent(broker.address)}`);
    await signIn();
    await button(page, "Disconnect").waitFor();
    await page.locator("[data-count=gateways]").waitFor();
  });
});
