// What every test of the page needs: simulated modules, a tmcld on them, and a browser that looks at its page.
import { spawn } from "node:child_process";
import { cp, mkdtemp, rm, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { createConnection, createServer } from "node:net";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { chromium } from "playwright-core";

const programs = process.env.TMCL_BIN;
// Generous: a busy machine is slow. Nothing waits for the whole of it.
export const patience = 60_000;

/** Waits until the condition holds; `what` says what is missing if it never does. */
export async function until(what, condition) {
  const ends = Date.now() + patience;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (Date.now() > ends) throw new Error(`has not come about: ${what}`);
    await new Promise((done) => setTimeout(done, 20));
  }
}

export class Program {
  /** `name`: of this project, or a path. */
  constructor(name, ...words) {
    this.output = "";
    this.process = spawn(resolve(programs, name), words);
    for (const stream of [this.process.stdout, this.process.stderr]) stream.on("data", (text) => (this.output += text));
    this.ended = new Promise((done) => this.process.on("exit", done));
  }
  says(text) {
    return until(`'${text}' of ${this.process.spawnfile}: ${this.output}`, () => this.output.includes(text));
  }
  async end(signal = "SIGTERM") {
    this.process.kill(signal);
    await this.ended;
  }
}

export async function freePort() {
  const server = createServer().listen(0, "127.0.0.1");
  await new Promise((done) => server.on("listening", done));
  const { port } = server.address();
  await new Promise((done) => server.close(done));
  return port;
}

export const axis = (name, motor, address = 1) => `[[axis]]
name = "${name}"
bus = "bench"
address = ${address}
motor = ${motor}
unit = "mm"
units_per_revolution = 8.0
soft_limits = [-200.0, 200.0]
max_velocity = 20
`;

/**
 * Modules at the addresses from 1 on; without other wishes a TMCM-3110 with the axes x, y and z of 8 mm a turn.
 * `isCabled`: tmcld reaches them through `cable`, and others past it on `modulesPort`.
 */
export class Bench {
  static async create({ keys = "loopback_without_token = true", axes = axis("x", 0) + axis("y", 1) + axis("z", 2), models = ["TMCM-3110"], hasOwnPage = false, isCabled = false } = {}) {
    const bench = new Bench();
    bench.folder = await mkdtemp(join(tmpdir(), "tmcl-page-"));
    // A copy, which a test may change.
    if (hasOwnPage) await cp(join(programs, "../share/tmcl/page"), join(bench.folder, "page"), { recursive: true });
    if (hasOwnPage) keys += `\npage = "${bench.folder}/page"`;
    bench.socket = join(bench.folder, "socket");
    bench.port = await freePort();
    bench.modulesPort = await freePort();
    const pty = join(bench.folder, "bus");
    const ports = ["--pty", pty, "--tcp", `127.0.0.1:${bench.modulesPort}`];
    bench.simulator = new Program("tmclsim", ...models.flatMap((model) => ["--module", model]), ...ports);
    await bench.simulator.says("ready");
    if (isCabled) bench.cable = await Cable.to(bench.modulesPort);
    const link = isCabled ? `tcp:127.0.0.1:${bench.cable.port}` : `serial:${pty}@115200`;
    await writeFile(
      join(bench.folder, "tmcld.toml"),
      `[daemon]\nsocket = "${bench.socket}"\n[http]\nlisten = ["127.0.0.1:${bench.port}"]\n${keys}\n` +
        `[[bus]]\nname = "bench"\nlink = "${link}"\nreply_timeout_ms = 1000\n${axes}`,
    );
    await bench.startDaemon();
    return bench;
  }

  async startDaemon() {
    this.daemon = new Program("tmcld", "--config", join(this.folder, "tmcld.toml"));
    await this.daemon.says("module_answers (module 1)");
  }

  get url() {
    return `http://localhost:${this.port}`;
  }

  /** A call on the socket of the daemon: each is another client. */
  call(method, params = {}) {
    return new Promise((resolve, reject) => {
      const connection = createConnection(this.socket);
      let text = "";
      connection.on("error", reject);
      connection.on("data", (data) => {
        text += data;
        // The greeting and news of its progress come before the answer; the last line is not whole.
        const lines = text.split("\n").slice(0, -1).map((line) => JSON.parse(line));
        const answer = lines.find((line) => line.id === 1);
        if (!answer) return;
        connection.destroy();
        if (answer.error) reject(new Error(answer.error.message));
        else resolve(answer.result);
      });
      connection.write(JSON.stringify({ jsonrpc: "2.0", id: 1, method, params }) + "\n");
    });
  }
  state(name) {
    return this.call("axis.get_state", { axis: name });
  }
  async token(role, name) {
    return (await this.call("token.add", { role, name })).token;
  }
  /** From now on its moves last longer than a busy machine is late. Gives what makes them as quick as before. */
  async slow(name) {
    const velocity = { axis: name, parameter: "max_velocity" };
    const { value } = await this.call("parameter.get", velocity);
    await this.call("parameter.set", { ...velocity, value: Math.floor(value / 30) });
    return () => this.call("parameter.set", { ...velocity, value });
  }
  moves(name) {
    return until(`${name} moves`, async () => (await this.state(name)).moving);
  }
  stands(name) {
    return until(`${name} stands`, async () => !(await this.state(name)).moving);
  }

  async end() {
    await this.daemon.end();
    this.cable?.end();
    await this.simulator.end();
    await rm(this.folder, { recursive: true });
  }
}

/** Between a browser and tmcld; what is cut carries nothing any more, and says nothing. */
export class Cable {
  #sockets = [];

  static async to(port) {
    const cable = new Cable();
    cable.server = createServer((near) => {
      const far = createConnection(port, "127.0.0.1");
      for (const socket of [near, far]) {
        cable.#sockets.push(socket);
        socket.on("error", () => {});
      }
      near.pipe(far).pipe(near);
      if (cable.isCut) cable.cut();
    }).listen(0, "127.0.0.1");
    await new Promise((done) => cable.server.on("listening", done));
    cable.port = cable.server.address().port;
    cable.url = `http://localhost:${cable.port}`;
    return cable;
  }
  cut() {
    this.isCut = true;
    for (const socket of this.#sockets) socket.unpipe().pause();
  }
  /** What was cut off is closed; new connections carry again. */
  mend() {
    this.isCut = false;
    for (const socket of this.#sockets.splice(0)) socket.destroy();
  }
  end() {
    this.mend();
    this.server.close();
  }
}

let browser;

/** A page in a browser of its own: no other page has its cookies. What it complains of is in `page.complaints`. */
export async function open(url, options = {}) {
  browser ??= await chromium.launch({ executablePath: process.env.TMCL_CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
  const context = await browser.newContext(options);
  const page = await context.newPage();
  page.setDefaultTimeout(patience);
  page.complaints = [];
  page.on("pageerror", (error) => page.complaints.push(String(error)));
  page.on("console", (message) => {
    if (/Content Security Policy/.test(message.text())) page.complaints.push(message.text());
  });
  await page.goto(url);
  return page;
}

export const closeBrowser = () => browser?.close();

export const card = (page, name) => page.locator(`[data-axis=${JSON.stringify(name)}]`);
export const button = (within, name) => within.getByRole("button", { name, exact: true });

export async function signIn(page, token) {
  await page.getByLabel("Token").fill(token);
  await button(page, "Sign in").click();
}

export async function move(page, name, to) {
  await card(page, name).getByRole("textbox").fill(to);
  await button(card(page, name), "Move").click();
}

/** What axe-core has against a page that was opened with bypassCSP, in light and in dark. */
export async function seriousFindings(page) {
  await page.addScriptTag({ path: createRequire(import.meta.url).resolve("axe-core") });
  const found = [];
  for (const colorScheme of ["light", "dark"]) {
    await page.emulateMedia({ colorScheme });
    const { violations } = await page.evaluate(() => window.axe.run());
    const serious = violations.filter((one) => ["serious", "critical"].includes(one.impact));
    found.push(...serious.map((one) => `${one.id}: ${one.nodes.map((node) => node.html).join(" ")}`));
  }
  return found;
}
