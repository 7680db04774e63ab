// The part of the page about buses: their load, what goes over them, and for whom.
import assert from "node:assert/strict";
import { createConnection } from "node:net";
import { after, afterEach, beforeEach, describe, it } from "node:test";
import { axis, Bench, button, closeBrowser, open, seriousFindings, signIn, until } from "./bench.mjs";

// It turns without end, for which it may have no soft limits.
const turntable = '[[axis]]\nname = "turntable"\nbus = "bench"\naddress = 1\nmotor = 0\n';

let bench, page;
after(closeBrowser);
afterEach(async () => {
  assert.deepEqual(page.complaints, []);
  await page.context().close();
  await bench.end();
});

const table = (caption) => page.getByRole("table", { name: caption });
const trace = () => table("Trace of bench");
const rowsOf = (where) => where.locator("tbody tr");
const firstOf = async (column) => Number(await rowsOf(trace()).first().locator("td").nth(column).textContent());

async function cell(head) {
  const heads = await table("Buses").locator("thead th").allTextContents();
  return rowsOf(table("Buses")).locator(":scope > *").nth(heads.indexOf(head)).textContent();
}

/** A client of the socket that stays until it is ended, with one call made. */
async function clientWith(method, params) {
  const connection = createConnection(bench.socket);
  let text = "";
  connection.on("data", (data) => (text += data));
  connection.write(JSON.stringify({ jsonrpc: "2.0", id: 1, method, params }) + "\n");
  await until(`an answer to ${method}`, () => text.split("\n").length > 2);
  assert.match(text, /"result"/);
  return connection;
}

describe("the part about buses", () => {
  beforeEach(async () => {
    bench = await Bench.create({ axes: axis("y", 1) + axis("z", 2) + turntable });
    page = await open(`${bench.url}/?tab=bus`);
    await rowsOf(trace()).first().waitFor();
  });

  it("shows the load and the counters of a bus, and keeps looking", async () => {
    const load = await until("a load", async () => (await cell("Load")).match(/^\d+\.\d %$/)?.[0]);
    const sent = Number(await cell("Sent"));
    assert.ok(sent > 0);
    await until("more is sent", async () => Number(await cell("Sent")) > sent);
    assert.ok(Number(await cell("Answered")) > 0);
    bench.simulator.process.kill("SIGSTOP");
    await until("a request is not answered", async () => Number(await cell("Timeouts")) > 0);
    await until("the load is another one", async () => (await cell("Load")) !== load);
    bench.simulator.process.kill("SIGCONT");
  });

  it("says that a bus is lost, and why", async () => {
    await bench.simulator.end("SIGKILL");
    await until("the bus is lost", async () => (await cell("State")) === "lost");
    await page.locator("p.problem").getByText(/^bench: /).waitFor();
  });

  it("shows the command of another client, with its meaning and its bytes", async () => {
    await page.getByLabel("Filter").fill("MVP,4711,to the module");
    await until("no other row is shown", async () => (await rowsOf(trace()).count()) === 0);
    await bench.call("axis.move_to", { axis: "y", position_microsteps: 4711 });
    const row = rowsOf(trace()).first();
    await row.getByText("MVP 0, 1, 4711 → 1").waitFor();
    assert.equal(await rowsOf(trace()).count(), 1);
    assert.match(await row.textContent(), /process \d+ of user/);
    assert.match(await row.locator(".bytes").textContent(), /^0104000100001267/);
  });

  it("shows 500 rows at most, and stands still while it is paused", async () => {
    await until("many rows", async () => (await rowsOf(trace()).count()) === 500);
    await button(page, "Pause").click();
    const newest = await firstOf(0);
    const sent = Number(await cell("Sent"));
    await until("more is sent", async () => Number(await cell("Sent")) > sent + 20);
    assert.equal(await firstOf(0), newest);
    assert.equal(await rowsOf(trace()).count(), 500);
    await button(page, "Go on").click();
    await until("newer rows", async () => (await firstOf(0)) > newest);
  });

  it("goes on when tmcld has started again", async () => {
    await bench.daemon.end();
    await page.getByText("Connecting ...").waitFor();
    await bench.startDaemon();
    await page.getByText("Connecting ...").waitFor({ state: "detached" });
    const newest = await firstOf(0);
    await until("newer rows", async () => (await firstOf(0)) !== newest);
  });

  it("shows who has axes, by a lease or without one", async () => {
    const holders = table("Axes that a client has");
    assert.equal(await rowsOf(holders).count(), 0);
    const leasing = await clientWith("lease.acquire", { axes: ["y", "z"], ttl_ms: 60000 });
    await holders.getByRole("row", { name: /^y, z process \d+ of user/ }).waitFor();
    const turning = await clientWith("axis.rotate", { axis: "turntable", velocity_internal: 100 });
    await holders.getByRole("row", { name: /^turntable process \d+ of user \d+ turns for this client/ }).waitFor();
    leasing.destroy();
    turning.destroy();
    await until("no client has an axis", async () => (await rowsOf(holders).count()) === 0);
  });

  it("examines the bench when it is asked to, and says what to try", async () => {
    await bench.call("parameter.set", { axis: "y", parameter: "max_current", value: 0 });
    assert.equal(await table("Findings").count(), 0);
    await button(page, "Examine").click();
    const finding = table("Findings").getByRole("row", { name: /^current y/ });
    await finding.waitFor();
    assert.match(await finding.locator("td").last().textContent(), /max_current/);
  });

  it("goes on a phone without scrolling sideways", async () => {
    await page.setViewportSize({ width: 360, height: 640 });
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 360);
  });

  it("can be read by a screen reader", async () => {
    const reader = await open(`${bench.url}/?tab=bus`, { bypassCSP: true });
    await button(reader, "Examine").click();
    await reader.getByRole("table", { name: "Findings" }).waitFor();
    await button(reader, "Pause").click();
    // One row is as good as 500, which take their time.
    const rows = rowsOf(reader.getByRole("table", { name: "Trace of bench" }));
    await reader.getByLabel("Filter").fill(await rows.first().locator("td").nth(1).textContent());
    await until("few rows", async () => (await rows.count()) < 100);
    assert.deepEqual(await seriousFindings(reader), []);
    await reader.context().close();
  });
});

describe("who asks on a bus", () => {
  beforeEach(async () => {
    bench = await Bench.create({ keys: "" });
    page = await open(`${bench.url}/?tab=bus`);
  });

  it("is shown with the role of its token, and all tokens with theirs", async () => {
    await bench.token("observe", "guest");
    await signIn(page, await bench.token("configure", "chief"));
    await table("Tokens").getByRole("row", { name: /^guest observe/ }).waitFor();
    await table("Tokens").getByRole("row", { name: /^chief configure/ }).waitFor();
    await button(page, "Examine").click();
    await table(/^Who has asked on bench/).getByRole("row", { name: /^token 'chief' from 127.0.0.1\S* configure/ }).waitFor();
  });

  it("is shown with what was done, and by whom", async () => {
    await signIn(page, await bench.token("configure", "chief"));
    const connected = table("Who is connected");
    await connected.getByRole("row", { name: /^token 'chief' from 127.0.0.1\S* WebSocket configure chief/ }).waitFor();
    const leasing = await clientWith("lease.acquire", { axes: ["y", "z"], ttl_ms: 60000 });
    await connected.getByRole("row", { name: /^process \d+ of user \d+ socket configure – y, z/ }).waitFor();
    leasing.destroy();
    await until("it has gone", async () => (await connected.getByText(/^process/).count()) === 0);
    const audit = table(/^Audit/);
    await bench.call("axis.stop", { axis: "y" });
    await audit.getByRole("row", { name: /process \d+ of user \d+ method=axis.stop params={"axis":"y"} outcome=done/ }).first().waitFor();
    await button(page, "Stop all").click();
    await until("the newest is the first", async () =>
      (await rowsOf(audit).first().textContent()).includes(`client="token 'chief' from`));
    assert.equal(await rowsOf(audit).first().locator("td").nth(2).textContent(), "–");
  });

  it("is shown without tokens to a guest", async () => {
    await signIn(page, await bench.token("observe", "guest"));
    await button(page, "Examine").click();
    await table(/^Who has asked on bench/).getByRole("row", { name: /^token 'guest' from/ }).waitFor();
    for (const name of ["Tokens", "Who is connected", /^Audit/]) assert.equal(await table(name).count(), 0);
    assert.equal(await page.getByRole("alert").count(), 0);
  });
});

describe("names on a bus", () => {
  const html = '<img src="x" onerror="document.title = 1">';

  it("are text, whatever they look like", async () => {
    bench = await Bench.create();
    page = await open("about:blank");
    const name = JSON.stringify(html);
    // tmcld takes no such names itself.
    await page.routeWebSocket("**/ws", (socket) => {
      const tmcld = socket.connectToServer();
      socket.onMessage((text) => tmcld.send(text.replaceAll(name, '"bench"')));
      tmcld.onMessage((text) => socket.send(text.replaceAll('"bench"', name).replace(/"(client|text|cure|token|door)":"(?:[^"\\]|\\.)*"/g, `"$1":${name}`)));
    });
    await page.goto(`${bench.url}/?tab=bus`);
    await page.getByRole("table", { name: `Trace of ${html}` }).getByText(html).first().waitFor();
    await table("Buses").getByText(html).waitFor();
    await button(page, "Examine").click();
    await table("Findings").getByText(html).first().waitFor();
    await bench.call("axis.stop", { axis: "x" });
    await table("Who is connected").getByText(html).first().waitFor();
    await table(/^Audit/).getByText(html).first().waitFor();
    assert.equal(await page.locator("img").count(), 0);
    assert.equal(await page.title(), "tmcld");
  });
});
