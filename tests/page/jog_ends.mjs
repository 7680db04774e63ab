// How long a motor turns on after each way in which a held jog button can end. Not run with the other tests: it takes a
// quarter of an hour. ROUNDS says how often each end is tried. The motor is asked on a port of its own, past tmcld.
import assert from "node:assert/strict";
import { createConnection } from "node:net";
import { after, before, describe, it } from "node:test";
import { axis, Bench, Cable, closeBrowser, open, signIn, until } from "./bench.mjs";

const rounds = Number(process.env.ROUNDS ?? 50);
const limit = 200;
const microstepsPerMm = (200 * 256) / 8;

/** Asks a simulated module by TCP. */
class Motor {
  #waiting = [];
  #bytes = Buffer.alloc(0);

  static async on(port) {
    const motor = new Motor();
    motor.socket = createConnection(port, "127.0.0.1");
    motor.socket.on("data", (bytes) => motor.#take(bytes));
    await new Promise((done, failed) => motor.socket.on("connect", done).on("error", failed));
    return motor;
  }
  end() {
    this.socket.destroy();
  }

  position = () => this.#get(1);
  velocity = () => this.#get(3);

  /** When it stands, by the clock of this process. */
  async stands() {
    await until("the motor stands", async () => (await this.velocity()) === 0);
    return Date.now();
  }

  #get(parameter) {
    return this.#ask(6, parameter, 0);
  }
  #ask(command, type, value) {
    const request = Buffer.alloc(9);
    request.set([1, command, type, 0]);
    request.writeInt32BE(value, 4);
    request[8] = request.subarray(0, 8).reduce((sum, byte) => (sum + byte) & 0xff, 0);
    this.socket.write(request);
    return new Promise((done) => this.#waiting.push(done));
  }
  #take(bytes) {
    this.#bytes = Buffer.concat([this.#bytes, bytes]);
    for (; this.#bytes.length >= 9; this.#bytes = this.#bytes.subarray(9)) this.#waiting.shift()(this.#bytes.readInt32BE(4));
  }
}

let bench, motor, network, token;
before(async () => {
  bench = await Bench.create({ keys: "", axes: axis("x", 0), isCabled: true });
  token = await bench.token("operate", "hand");
  motor = await Motor.on(bench.modulesPort);
});
after(async () => {
  motor.end();
  await bench.end();
  await closeBrowser();
});

/** A page with a button held that drives the axis away from its nearer limit, at full speed. */
async function held() {
  network = await Cable.to(bench.port);
  const page = await open(network.url);
  await signIn(page, token);
  const sign = (await motor.position()) > 0 ? "\u2212" : "\\+";
  const jog = page.getByRole("button", { name: new RegExp(`^x by ${sign}`) });
  await jog.scrollIntoViewIfNeeded();
  const box = await jog.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await until("the axis has its speed", async () => {
    const before = await motor.velocity();
    await new Promise((done) => setTimeout(done, 50));
    return before !== 0 && (await motor.velocity()) === before;
  });
  return page;
}

const inTheMiddle = (sorted) => sorted[Math.floor(sorted.length / 2)];
const ofHundred99 = (sorted) => sorted[Math.ceil(0.99 * sorted.length) - 1];
const sortedBy = (numbers) => numbers.sort((one, other) => one - other);

/** How long it turns on, and how far, after what `end` does with a page; `mend` puts the bench in order again. */
async function measure(end, mend = async () => {}) {
  const [times, ways] = [[], []];
  for (let round = 0; round < rounds; ++round) {
    const page = await held();
    const [from, began] = [await motor.position(), Date.now()];
    const ended = end(page);
    const stoodAt = await motor.stands();
    await ended;
    times.push(stoodAt - began);
    const at = await motor.position();
    assert.ok(Math.abs(at) < limit * microstepsPerMm, "within its limits");
    ways.push(Math.abs(at - from) / microstepsPerMm);
    await mend();
    await page.context().close();
    network.end();
    await until("its lease is given back", async () => (await bench.state("x")).lease === null);
  }
  return { times: sortedBy(times), ways: sortedBy(ways) };
}

const debuggerOf = (page) => page.context().newCDPSession(page);
const ends = [
  ["the button is released", (page) => page.mouse.up()],
  ["the page is closed", (page) => page.close()],
  ["the page crashes", async (page) => void (await debuggerOf(page)).send("Page.crash").catch(() => {})],
  [
    "the page's scripts stand still",
    async (page) => {
      const session = await debuggerOf(page);
      await session.send("Debugger.enable");
      await session.send("Debugger.pause");
    },
  ],
  ["its tab is hidden", (page) => page.evaluate(() => document.dispatchEvent(new Event("visibilitychange", { bubbles: true })))],
  ["the browser loses the window", (page) => page.evaluate(() => window.dispatchEvent(new Event("blur")))],
  ["its network is cut", () => network.cut()],
  ["tmcld stands still", () => void bench.daemon.process.kill("SIGSTOP"), () => bench.daemon.process.kill("SIGCONT")],
  ["tmcld is killed", () => void bench.daemon.process.kill("SIGKILL"), () => bench.startDaemon()],
  [
    "the cable to the module is cut",
    () => bench.cable.cut(),
    async () => {
      bench.cable.mend();
      await until("the module answers", () => bench.call("parameter.get", { axis: "x", parameter: 1 }).then(() => true, () => false));
    },
  ],
];

describe(`a jog ends, ${rounds} times each`, { timeout: 7_200_000 }, () => {
  for (const [name, end, mend] of ends) {
    it(`when ${name}`, async () => {
      const { times, ways } = await measure(async (page) => end(page), mend);
      console.log(
        `${name}: it stood after ${inTheMiddle(times)} ms in the middle, ${ofHundred99(times)} ms (99 of 100), ${times.at(-1)} ms at most; ` +
          `it went on by ${inTheMiddle(ways).toFixed(2)} mm, ${ways.at(-1).toFixed(2)} mm at most`,
      );
    });
  }
});
