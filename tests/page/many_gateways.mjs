// Many gateways on a broker, as one process that speaks for all of them: what fleet_load.mjs looks at. It answers stops.
//
//     many_gateways.mjs PORT GATEWAYS AXES KIND MESSAGES_PER_SECOND
//
// KIND is state, telemetry or none. Once a second it prints how many messages it has sent.
import { connect as connectTo } from "node:net";
import { fleetModules } from "./sources.mjs";

const [port, gateways, axes] = process.argv.slice(2, 5).map(Number);
const [kind, perSecond] = [process.argv[5], Number(process.argv[6])];
const { packets } = await fleetModules("many_gateways_sources.js");

const tickMs = 20;
const names = Array.from({ length: gateways }, (_, index) => `hall${1 + Math.floor(index / 100)}-${1 + (index % 100)}`);
const axisNames = Array.from({ length: axes }, (_, index) => `a${index + 1}`);

const socket = connectTo(port, "127.0.0.1");
let carry = "";
let stops = 0;
let isConnected;
const connected = new Promise((done) => (isConnected = done));
/** As the page makes them, but for speed. */
function say(topic, payload, retained) {
  const text = Buffer.from(JSON.stringify(payload));
  const size = 2 + topic.length + 1 + text.length;
  const head = Buffer.from([0x30 | (retained ? 1 : 0), (size & 127) | (size > 127 ? 128 : 0), ...(size > 127 ? [size >> 7] : []), topic.length >> 8, topic.length & 255]);
  socket.write(Buffer.concat([head, Buffer.from(topic), Buffer.from([0]), text]));
}

socket.on("data", (data) => {
  isConnected();
  // The topic for answers is the only text in a stop that ends in an identity of a press.
  const text = carry + data.toString("latin1");
  let end = 0;
  for (const found of text.matchAll(/tmcl\/v1\/reply\/(\w+)\/([\w-]+)\/([0-9a-f]{24})/g)) {
    answer(found[1], found[2], found[3]);
    end = found.index + found[0].length;
  }
  carry = text.slice(end).slice(-200);
});

function answer(user, scope, id) {
  ++stops;
  const result = { stopped: axisNames.map((axis) => ({ axis, milliseconds: 3 })), failed: [] };
  for (const name of scope === "all" ? names : [scope]) say(`tmcl/v1/reply/${user}/${name}/${id}`, { result, epoch: `e-${name}` }, false);
}

const movement = (step) => ({
  position_microsteps: step,
  velocity_internal: 120,
  velocity_pps: 915.5,
  position: step / 6400,
  velocity: 0.143,
  position_reached: false,
});
const state = (axis, step) => ({
  axis,
  ...movement(step),
  target_microsteps: 512000,
  moving: step % 7 !== 0,
  unit: "mm",
  target: 80,
  latched: false,
  referenced: true,
  stop_cause: null,
  lease: null,
  unattended: false,
  owner: null,
  faults: [],
  unrestored: [],
});

socket.write(packets.connect({ client: "many", user: "chaos", password: "chaos", keepAliveS: 0 }));
await connected;
socket.write(packets.subscribe(1, ["tmcl/v1/+/stop"]));
for (const name of names) {
  say(`tmcl/v1/${name}/birth`, { online: true, epoch: `e-${name}`, nonce_ttl_ms: 2000, tmcld_mqtt: "1", tmcld: "1", axes: axisNames }, true);
  for (const axis of axisNames) say(`tmcl/v1/${name}/state/${axis}`, state(axis, 0), true);
}
await new Promise((done) => socket.write(packets.pingreq(), done));
console.log("born");

let [sent, step, told] = [0, 0, performance.now()];
const began = performance.now();
setInterval(() => {
  const due = ((performance.now() - began) / 1000) * perSecond;
  while (kind !== "none" && sent < due && socket.writableLength < 1_000_000) {
    const [name, axis] = [names[Math.floor(step / axes) % gateways], axisNames[step % axes]];
    if (kind === "state") say(`tmcl/v1/${name}/state/${axis}`, state(axis, step), true);
    else say(`tmcl/v1/${name}/telemetry/${axis}`, movement(step), false);
    [sent, step] = [sent + 1, step + 1];
  }
  if (performance.now() - told < 1000) return;
  told = performance.now();
  console.log(`sent ${sent} in ${((told - began) / 1000).toFixed(1)} s, ${stops} stops`);
}, tickMs);
