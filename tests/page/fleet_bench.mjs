// A fleet: a mosquitto with the configuration of config/fleet, and gateways with a tmcld and a simulator each.
import { execFile, execFileSync, spawnSync } from "node:child_process";
import { cp, mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { connect as connectTo } from "node:net";
import { tmpdir, userInfo } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import { axis, Bench, freePort, Program, until } from "./bench.mjs";
import { fleetModules } from "./sources.mjs";

const mosquitto = process.env.TMCL_MOSQUITTO ?? "/usr/sbin/mosquitto";
const configs = join(process.env.TMCL_ROOT, "config/fleet");
const page = join(process.env.TMCL_BIN, "../share/tmcl/page/fleet.html");
const rights = `[[access]]\nrole = "operate"\nusers = ["${userInfo().username}"]\nrelay = true`;
export const password = "secret of anna";

const { packets } = await fleetModules("fleet_bench_sources.js");

export class Broker {
  /** With a listener without TLS beside the others, where the user chaos may write anything. */
  static async create() {
    const broker = new Broker();
    broker.folder = await mkdtemp(join(tmpdir(), "tmcl-fleet-"));
    broker.files = join(broker.folder, "files");
    for (const port of ["gatewayPort", "pagePort", "filesPort", "plainPort"]) broker[port] = await freePort();
    broker.#makeCertificates();
    await mkdir(broker.files);
    await broker.#writeFiles();
    await broker.start();
    return broker;
  }

  async start() {
    this.program = new Program(mosquitto, "-c", join(this.folder, "mosquitto.conf"));
    await this.program.says(" running");
  }

  #openssl(words) {
    execFileSync("openssl", words.split(" "), { cwd: this.folder, stdio: "pipe" });
  }
  #makeCertificates() {
    const made = "-newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes";
    this.#openssl(`req -x509 ${made} -days 2 -subj /CN=fleet -keyout ca.key -out ca.crt`);
    this.certify("broker");
  }
  /** For a name, from the authority of this fleet. */
  certify(name) {
    this.#openssl(`req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /CN=${name} -addext subjectAltName=DNS:localhost -keyout ${name}.key -out ${name}.csr`);
    this.#openssl(`x509 -req -in ${name}.csr -CA ca.crt -CAkey ca.key -CAcreateserial -days 2 -copy_extensions copy -out ${name}.crt`);
  }

  async #writeFiles() {
    const text = await readFile(join(configs, "mosquitto.conf"), "utf8");
    const web = await readFile(join(configs, "websocket.conf"), "utf8");
    const both = `${text}\n${web}`
      .replace("listener 8883", `listener ${this.gatewayPort} 127.0.0.1`)
      .replace("listener 9001", `listener ${this.pagePort}`)
      .replaceAll("/etc/mosquitto/certs/", `${this.folder}/`)
      .replaceAll("/etc/mosquitto/", `${this.folder}/`)
      .replace(/^# (listener 9002|protocol websockets|http_dir .*)$/gm, "$1")
      .replace("listener 9002", `listener ${this.filesPort}`)
      .replace("/usr/local/share/tmcl/fleet", this.files);
    const more = `listener ${this.plainPort} 127.0.0.1\nuser ${userInfo().username}\n`;
    await writeFile(join(this.folder, "mosquitto.conf"), `${both}\n${more}`);
    const acl = await readFile(join(configs, "tmcl.acl"), "utf8");
    await writeFile(join(this.folder, "tmcl.acl"), `${acl}\nuser chaos\ntopic readwrite #\n`, { mode: 0o600 });
    for (const [name, words] of [["anna", password], ["chaos", "chaos"]])
      execFileSync("mosquitto_passwd", [...(name === "anna" ? ["-c"] : []), "-b", join(this.folder, "tmcl.passwd"), name, words]);
    await cp(page, join(this.files, "index.html"));
  }

  /** Of its WebSocket with TLS. */
  get address() {
    return `wss://localhost:${this.pagePort}`;
  }
  /** Of the page, which its listener without TLS gives. */
  get url() {
    return `http://localhost:${this.filesPort}/?broker=${encodeURIComponent(this.address)}`;
  }

  /** May write to every topic. */
  async publisher() {
    const socket = connectTo(this.plainPort, "127.0.0.1");
    const came = new Promise((done) => socket.once("data", done));
    socket.write(packets.connect({ client: "chaos", user: "chaos", password: "chaos", keepAliveS: 0 }));
    await came;
    return {
      say: (topic, payload, retained = true, more = {}) =>
        new Promise((done) => socket.write(packets.publish({ topic, payload, retained, ...more }), done)),
      end: () => socket.destroy(),
    };
  }

  /** What the broker keeps there; empty: nothing. */
  retained(topic) {
    const words = ["-V", "5", "-p", this.plainPort, "-u", "chaos", "-P", "chaos", "-t", topic, "-C", "1", "-W", "1", "--retained-only"];
    return spawnSync("mosquitto_sub", words.map(String)).stdout.toString();
  }

  /** Of the press whose stops go out now, again and again. */
  async idOfStop() {
    const words = ["-V", "5", "-p", this.plainPort, "-u", "chaos", "-P", "chaos", "-t", "tmcl/v1/+/stop", "-C", "1", "-W", "30", "-F", "%R"];
    const { stdout } = await promisify(execFile)("mosquitto_sub", words.map(String));
    return stdout.trim().split("/").at(-1);
  }

  async end() {
    await this.program.end();
    await rm(this.folder, { recursive: true });
  }
}

/** A bench of simulated modules whose tmcld is on the broker. */
export class Gateway {
  static async create(broker, name, axes = axis("x", 0) + axis("y", 1)) {
    const gateway = new Gateway();
    [gateway.name, gateway.broker] = [name, broker];
    gateway.bench = await Bench.create({ keys: `loopback_without_token = true\n${rights}`, axes });
    broker.certify(name);
    await writeFile(
      join(gateway.bench.folder, "mqtt.toml"),
      `[mqtt]\nbroker = "localhost:${broker.gatewayPort}"\ngateway = "${name}"\nsocket = "${gateway.bench.socket}"\nca = "${broker.folder}/ca.crt"\n` +
        `certificate = "${broker.folder}/${name}.crt"\nkey = "${broker.folder}/${name}.key"\n`,
    );
    // Slow: what is to be stopped has not arrived before, however busy the computer is.
    for (const name of ["x", "y"]) await gateway.bench.call("parameter.set", { axis: name, parameter: "max_velocity", value_in_unit: 2 });
    await gateway.start();
    return gateway;
  }
  async start() {
    this.mqtt = new Program("tmcld-mqtt", "--config", join(this.bench.folder, "mqtt.toml"));
    await this.mqtt.says(`gateway ${this.name} is on broker`);
  }
  /** As an operator beside it does. */
  tmclctl(...words) {
    return execFileSync(join(process.env.TMCL_BIN, "tmclctl"), ["--socket", this.bench.socket, ...words]);
  }
  async end() {
    this.mqtt.process.kill("SIGCONT");
    await this.mqtt.end();
    await this.bench.end();
  }
}
