// What the page of a fleet decides, without a browser: what it takes from a broker, and what it says there.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { fleetModules } from "./sources.mjs";

const { address, fleet: fleets, glob, messages, packets, rows, stop_run, topics, wishes } = await fleetModules("fleet_logic_sources.js");
const { Fleet, presenceOf } = fleets;

// mulberry32: a run with the same seed draws the same.
const seed = Number(process.env.TMCL_SEED ?? Date.now() % 2 ** 32);
console.log(`seed ${seed} (TMCL_SEED)`);
let drawn = seed;
function draw(below) {
  drawn = (drawn + 0x6d2b79f5) | 0;
  let mixed = Math.imul(drawn ^ (drawn >>> 15), 1 | drawn);
  mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
  return ((mixed ^ (mixed >>> 14)) >>> 0) % below;
}
const oneOf = (list) => list[draw(list.length)];
const bytes = (said) => new TextEncoder().encode(typeof said === "string" ? said : JSON.stringify(said));

const birth = (epoch, axes = ["x", "y"], tmcld = "1.0") => ({ online: true, epoch, nonce_ttl_ms: 2000, tmcld_mqtt: "1", tmcld, axes });
const death = (epoch) => ({ online: false, epoch });
const state = (axis, more = {}) => ({
  axis,
  position_microsteps: 6400,
  velocity_internal: 0,
  velocity_pps: 0,
  target_microsteps: 6400,
  position_reached: true,
  moving: false,
  unit: "mm",
  position: 1,
  velocity: 0,
  target: 1,
  latched: false,
  referenced: true,
  stop_cause: null,
  lease: null,
  unattended: false,
  owner: null,
  faults: [],
  unrestored: [],
  ...more,
});

/** What a broker with these messages makes of a fleet. */
function fleetOf(...said) {
  const fleet = new Fleet();
  for (const [topic, payload] of said) hear(fleet, topic, payload);
  return fleet;
}
function hear(fleet, topic, payload) {
  const read = topics.read(`tmcl/v1/${topic}`);
  if (read) fleet.take(read, bytes(payload));
}

describe("packets of MQTT", () => {
  const text = (value) => [0, value.length, ...bytes(value)];
  const publication = (topic, payload) => [0x30, 2 + topic.length + 1 + payload.length, ...text(topic), 0, ...bytes(payload)];
  const readAll = (parts) => {
    const reader = new packets.PacketReader();
    return parts.flatMap((part) => [...reader.read(Uint8Array.from(part))].map((packet) => ({ ...packet, payload: packet.payload && [...packet.payload] })));
  };

  it("have the bytes that the standard asks for", () => {
    const login = { client: "c", user: "anna", password: "p", keepAliveS: 120 };
    const most = [0x27, 0, 0x12, 0x4f, 0x80];
    assert.deepEqual([...packets.connect(login)], [0x10, 28, ...text("MQTT"), 5, 0xc2, 0, 120, 5, ...most, ...text("c"), ...text("anna"), ...text("p")]);
    assert.deepEqual([...packets.connect({ ...login, password: "" })].slice(0, 10), [0x10, 25, ...text("MQTT"), 5, 0x82]);
    const wish = { topic: "a", payload: "w", retained: true, qos: 1, packet: 258, expiryS: 60, responseTopic: "r" };
    assert.deepEqual([...packets.publish(wish)], [0x33, 16, ...text("a"), 1, 2, 9, 2, 0, 0, 0, 60, 8, ...text("r"), 0x77]);
    assert.deepEqual([...packets.subscribe(3, ["a", "b"])], [0x82, 11, 0, 3, 0, ...text("a"), 0, ...text("b"), 0]);
    assert.deepEqual([...packets.unsubscribe(3, ["a"])], [0xa2, 6, 0, 3, 0, ...text("a")]);
    assert.deepEqual([...packets.puback(3)], [0x40, 2, 0, 3]);
  });

  it("are read however they are cut", () => {
    for (let round = 0; round < 200; ++round) {
      const said = Array.from({ length: 1 + draw(5) }, (_, index) => [`t/${index}`, "x".repeat(draw(100))]);
      const whole = said.flatMap(([topic, payload]) => publication(topic, payload));
      const parts = [];
      for (let at = 0; at < whole.length; ) {
        const next = at + 1 + draw(20);
        parts.push(whole.slice(at, next));
        at = next;
      }
      assert.deepEqual(readAll(parts).map(({ topic, payload }) => [topic, payload]), said.map(([topic, payload]) => [topic, [...bytes(payload)]]));
    }
  });

  it("of a broker say whether it has taken something", () => {
    const read = readAll([[0x20, 3, 0, 0x86, 0], [0x40, 3, 0, 7, 0x87], [0x40, 2, 0, 7], [0xe0, 1, 0x8b], [0xd0, 0]]);
    assert.deepEqual(read.map(({ is, reason }) => [is, reason]), [
      ["connack", 0x86],
      ["puback", 0x87],
      ["puback", 0],
      ["disconnect", 0x8b],
      ["other", undefined],
    ]);
  });

  it("that are none end the reading, and nothing else", () => {
    for (let round = 0; round < 5000; ++round) {
      const noise = Array.from({ length: 1 + draw(40) }, () => draw(256));
      try {
        readAll([noise]);
      } catch (error) {
        assert.ok(error instanceof packets.BadPacket, `${noise}: ${error.stack}`);
      }
    }
    assert.throws(() => readAll([[0x30, 0xff, 0xff, 0xff, 0x7f]]), packets.BadPacket, "longer than was agreed");
  });
});

describe("topics", () => {
  it("are those of gateways", () => {
    assert.deepEqual(topics.read("tmcl/v1/hall3-1/birth"), { is: "birth", gateway: "hall3-1" });
    assert.deepEqual(topics.read("tmcl/v1/g/state/x"), { is: "state", gateway: "g", axis: "x" });
    assert.deepEqual(topics.read("tmcl/v1/g/telemetry/x"), { is: "telemetry", gateway: "g", axis: "x" });
    assert.deepEqual(topics.read("tmcl/v1/reply/anna/g/7f"), { is: "reply", user: "anna", gateway: "g", id: "7f" });
  });
  it("of anything else are none", () => {
    const others = ["", "tmcl/v1", "tmcl/v1/", "tmcl/v2/g/birth", "tmcl/v1/g/birth/", "tmcl/v1//birth", "tmcl/v1/+/birth", "tmcl/v1/g h/birth", "tmcl/v1/<b>/birth"];
    const names = ["tmcl/v1/all/birth", "tmcl/v1/reply/birth", "tmcl/v1/g/state", "tmcl/v1/g/state/x/y", "tmcl/v1/g/state/#", "tmcl/v1/g/stop", "tmcl/v1/reply/anna/all/7f", "tmcl/v1/reply/anna/g"];
    for (const topic of [...others, ...names, `tmcl/v1/${"g".repeat(65)}/birth`, `tmcl/v1/g/state/${"x".repeat(300)}`]) assert.equal(topics.read(topic), null, topic);
  });
});

it("a pattern fits the names that a regular expression fits", () => {
  for (let round = 0; round < 5000; ++round) {
    const word = (letters, length) => Array.from({ length: draw(length) }, () => oneOf(letters)).join("");
    const [pattern, name] = [word("aB.*?", 7), word("ab.", 9)];
    const expected = pattern === "" || new RegExp(`^${pattern.replace(/[.]/g, "\\.").replace(/\*/g, ".*").replace(/\?/g, ".")}$`, "i").test(name);
    assert.equal(glob.fits(pattern, name), expected, `${pattern} ${name}`);
  }
  assert.ok(!glob.fits("*a".repeat(5000), "a".repeat(64)), "at once");
});

describe("a fleet", () => {
  it("has gateways that are there, away, and without tmcld", () => {
    const fleet = fleetOf(["g10/birth", birth("e")], ["g2/birth", death("e")], ["g1/birth", birth("e", [], null)], ["g10/state/x", state("x", { moving: true })]);
    assert.deepEqual(fleet.gateways().map((one) => [one.name, presenceOf(one)]), [["g1", "without_tmcld"], ["g2", "away"], ["g10", "online"]]);
    assert.deepEqual(fleet.counts(), { online: 1, away: 1, withoutTmcld: 1, axes: 2, moving: 1, withFaults: 0 });
    assert.equal(fleet.misread, 0);
  });

  it("does not take the death of a connection that another one has followed", () => {
    const fleet = fleetOf(["g/birth", birth("first")], ["g/birth", birth("second")], ["g/birth", death("first")]);
    assert.equal(presenceOf(fleet.gateway("g")), "online");
    hear(fleet, "g/birth", death("second"));
    assert.equal(presenceOf(fleet.gateway("g")), "away");
  });
  it("takes the death of a connection whose birth was not heard", () => {
    const fleet = fleetOf(["g/birth", birth("first")], ["g/birth", death("second")]);
    assert.equal(presenceOf(fleet.gateway("g")), "away");
    hear(fleet, "g/birth", birth("third"));
    assert.equal(presenceOf(fleet.gateway("g")), "online");
  });
  it("takes each death of the newest connection, in any order of births that was heard", () => {
    for (let round = 0; round < 500; ++round) {
      const fleet = new Fleet();
      let newest = "";
      for (let turn = 0; turn < 20; ++turn) {
        newest = `e${round}-${turn}`;
        hear(fleet, "g/birth", birth(newest));
        if (turn > 0 && draw(2) === 0) hear(fleet, "g/birth", death(`e${round}-${turn - 1}`));
        assert.equal(presenceOf(fleet.gateway("g")), "online");
      }
      hear(fleet, "g/birth", death(newest));
      assert.equal(presenceOf(fleet.gateway("g")), "away");
    }
  });

  it("has a gateway no more that was taken off the broker", () => {
    const fleet = fleetOf(["g/birth", birth("e")], ["g/birth", ""]);
    assert.deepEqual(fleet.gateways(), []);
  });

  it("shows telemetry on the way, of axes whose state is known", () => {
    const told = { position_microsteps: 7, velocity_pps: 5, position: 0.5, velocity: 0.1, velocity_internal: 3, position_reached: false };
    const fleet = fleetOf(["g/birth", birth("e")], ["g/telemetry/x", told], ["g/state/x", state("x", { owner: "anna" })], ["g/telemetry/x", told]);
    assert.equal(fleet.gateway("g").states.get("x").position, 0.5);
    assert.equal(fleet.gateway("g").states.get("x").owner, "anna");
    assert.equal(fleet.gateway("g").states.has("y"), false);
  });

  it("knows what the broker has left out", () => {
    const fleet = fleetOf(["g/birth", birth("e")], ["g/state/x", state("x")], ["h/state/x", state("x")], ["i/birth", birth("e", ["x"])], ["i/state/x", state("x")]);
    assert.deepEqual(fleet.incomplete(), { births: ["h"], states: ["g"] });
    assert.deepEqual(fleet.gateways().map(({ name }) => name), ["g", "i"], "h is not drawn");
  });

  it("takes nothing that no gateway would say", () => {
    const wrong = [
      ["g/birth", "no JSON"],
      ["g/birth", "[]"],
      ["g/birth", "null"],
      ["g/birth", { ...birth("e"), online: "yes" }],
      ["g/birth", { ...birth("e"), axes: "xy" }],
      ["g/birth", { ...birth("e"), axes: [1] }],
      ["g/birth", { ...birth("e"), axes: ["a/b"] }],
      ["g/birth", { ...birth("e"), axes: ["+"] }],
      ["g/birth", { ...birth("e"), axes: ["<img src=x>"] }],
      ["g/birth", { ...birth("e"), axes: Array(513).fill("x") }],
      ["g/birth", { ...birth("e"), epoch: 5 }],
      ["g/birth", { ...birth("e"), more: "x".repeat(70_000) }],
      ["g/state/x", state("y")],
      ["g/state/x", { ...state("x"), moving: 1 }],
      ["g/state/x", { ...state("x"), position: "1e999" }],
      ["g/state/x", JSON.stringify(state("x")).replace('"position":1', '"position":1e999')],
      ["g/state/x", { ...state("x"), faults: "stall" }],
      ["g/state/x", { ...state("x"), owner: {} }],
      ["g/state/x", { ...state("x"), owner: "x".repeat(300) }],
      ["g/state/x", '{"__proto__":{"axis":"x"}}'],
      ["g/telemetry/x", { position_microsteps: null }],
    ];
    for (const [topic, payload] of wrong) {
      const fleet = fleetOf([topic, payload]);
      assert.equal(fleet.misread, 1, `${topic} ${JSON.stringify(payload).slice(0, 100)}`);
      assert.deepEqual(fleet.gateways(), []);
      assert.equal(fleet.gateway("g").states.size, 0);
    }
  });

  it("keeps what is true when a message is damaged", () => {
    const whole = { birth: JSON.stringify(birth("e")), state: JSON.stringify(state("x")) };
    for (let round = 0; round < 3000; ++round) {
      const fleet = fleetOf(["g/birth", birth("e")], ["g/state/x", state("x")]);
      const kind = oneOf(["birth", "state"]);
      const at = draw(whole[kind].length);
      const damaged = whole[kind].slice(0, at) + oneOf(['"', "{", "null", "9e9", "", "\\", "<"]) + whole[kind].slice(at + draw(4));
      hear(fleet, kind === "birth" ? "g/birth" : "g/state/x", damaged);
      const shown = fleet.gateway("g")?.states.get("x");
      for (const key of ["position_microsteps", "target_microsteps"]) assert.ok(Number.isFinite(shown?.[key] ?? 0), damaged);
      for (const axis of fleet.gateway("g")?.birth?.axes ?? []) assert.ok(topics.isLevel(axis), damaged);
    }
  });

  it("has an end to what it keeps", () => {
    const fleet = new Fleet();
    for (let gateway = 0; gateway < 10_050; ++gateway) hear(fleet, `g${gateway}/birth`, birth("e"));
    assert.equal(fleet.gateways().length, 10_000);
    for (let axis = 0; axis < 600; ++axis) hear(fleet, `g1/state/x${axis}`, state(`x${axis}`));
    assert.equal(fleet.gateway("g1").states.size, 512);
  });
});

it("wishes are renewed, and taken back where nothing is shown any more", () => {
  const one = new wishes.Wishes();
  assert.deepEqual(one.due(["a", "b"], 0), { wish: ["a", "b"], end: [], first: ["a", "b"] });
  assert.deepEqual(one.due(["a", "b"], 19_999), { wish: [], end: [], first: [] });
  assert.deepEqual(one.due(["b", "c"], 20_000), { wish: ["b", "c"], end: ["a"], first: ["c"] });
  assert.deepEqual(one.due([], 20_001), { wish: [], end: ["b", "c"], first: [] });
  one.due(["a"], 30_000);
  one.forget();
  assert.deepEqual(one.due(["a"], 30_001), { wish: ["a"], end: [], first: ["a"] });
  assert.ok(wishes.wishExpiryS * 1000 > 2 * 20_000, "one renewal may be lost");
});

describe("a stop", () => {
  const { StopRun } = stop_run;
  const answer = (stopped, failed = []) =>
    messages.readStopAnswer(bytes({ result: { stopped: stopped.map((axis) => ({ axis, milliseconds: 2 })), failed: failed.map((axis) => ({ axis, error: { message: "silent" } })) } }));
  const refusal = (message) => messages.readStopAnswer(bytes({ error: { message }, epoch: "e" }));
  const two = () => fleetOf(["g/birth", birth("e")], ["h/birth", birth("e", ["z"])], ["i/birth", death("e")]);

  it("goes to all, and then to those that have not answered, every 100 ms", () => {
    const [fleet, run] = [two(), new StopRun("all", "id", 0)];
    assert.deepEqual(run.due(fleet, 0), ["all"]);
    assert.deepEqual(run.due(fleet, 99), []);
    assert.deepEqual(run.due(fleet, 100), ["g", "h"]);
    run.take("g", answer(["x", "y", "2/2"]));
    assert.deepEqual(run.due(fleet, 200), ["h"]);
    assert.deepEqual(run.report(1500).missing, [{ gateway: "h", axis: "", why: { is: "no_answer", seconds: 1 } }]);
    assert.equal(run.verdictOn("g", "x", 200), "confirmed");
    assert.equal(run.verdictOn("h", "z", 200), "notConfirmed");
    assert.equal(run.verdictOn("i", "z", 200), null);
    run.take("h", answer(["z"]));
    assert.deepEqual(run.due(fleet, 300), []);
    assert.deepEqual(run.report(300), { scope: "all", isOver: true, done: ["g", "h"], axes: 4, missing: [] });
  });

  it("asks again for an axis that has failed, and for one that is left out", () => {
    const [fleet, run] = [two(), new StopRun("all", "id", 0)];
    run.due(fleet, 0);
    run.take("h", answer(["z"]));
    run.take("g", answer([], ["x"]));
    assert.deepEqual(run.report(0).missing.map(({ axis, why }) => [axis, why.is]), [["x", "error"], ["y", "left_out"]]);
    assert.deepEqual(run.due(fleet, 100), ["g"]);
    run.take("g", answer(["x"], ["y"]));
    assert.deepEqual(run.due(fleet, 200), ["g"]);
    assert.ok(!run.isConfirmed());
    run.take("g", answer(["x", "y"]));
    assert.ok(run.isOver(200) && run.isConfirmed());
  });

  it("is not confirmed by a gateway that says why not", () => {
    const [fleet, run] = [fleetOf(["g/birth", birth("e", [], null)]), new StopRun("all", "id", 0)];
    run.due(fleet, 0);
    run.take("g", refusal("tmcld is not there"));
    assert.ok(!run.isOver(0));
    assert.deepEqual(run.report(0).missing, [{ gateway: "g", axis: "", why: { is: "error", message: "tmcld is not there" } }]);
  });

  it("waits no more for a gateway that has left the broker, and says so", () => {
    const [fleet, run] = [two(), new StopRun("all", "id", 0)];
    run.due(fleet, 0);
    run.take("g", answer(["x", "y"]));
    hear(fleet, "h/birth", death("e"));
    assert.deepEqual(run.due(fleet, 100), []);
    assert.deepEqual(run.report(100).missing, [{ gateway: "h", axis: "", why: { is: "gone" } }]);
    assert.ok(run.isOver(100));
    assert.ok(!run.isConfirmed());
  });

  it("has an end, and names what has not confirmed then", () => {
    const [fleet, run] = [two(), new StopRun("all", "id", 0)];
    for (let now = 0; now <= 30_000; now += 100) run.due(fleet, now);
    assert.deepEqual(run.due(fleet, 30_001), []);
    assert.deepEqual([run.report(30_001).isOver, run.report(30_001).done], [true, []]);
  });

  it("is not over where no gateway is known yet", () => {
    const [fleet, run] = [new Fleet(), new StopRun("all", "id", 0)];
    assert.deepEqual(run.due(fleet, 0), ["all"]);
    assert.deepEqual(run.due(fleet, 100), ["all"]);
    hear(fleet, "g/birth", birth("e"));
    assert.deepEqual(run.due(fleet, 200), ["g"]);
  });

  it("of one gateway concerns no other", () => {
    const [fleet, run] = [two(), new StopRun("h", "id", 0)];
    assert.deepEqual(run.due(fleet, 0), ["h"]);
    run.take("g", answer(["x", "y"]));
    assert.deepEqual(run.report(0).done, []);
    run.take("h", answer(["z"]));
    assert.deepEqual(run.report(0).done, ["h"]);
  });

  it("asks 200 gateways at a time, and leaves none out", () => {
    const names = Array.from({ length: 450 }, (_, index) => `g${index}`);
    const [fleet, run] = [fleetOf(...names.map((name) => [`${name}/birth`, birth("e")])), new StopRun("all", "id", 0)];
    run.due(fleet, 0);
    const asked = [1, 2, 3].flatMap((tick) => {
      const some = run.due(fleet, 100 * tick);
      assert.ok(some.length <= 200);
      return some;
    });
    assert.equal(new Set(asked).size, 450);
  });

  it("is confirmed only if all axes of all gateways are, in any order of answers and losses", () => {
    for (let round = 0; round < 500; ++round) {
      const names = ["g", "h", "i"].slice(0, 1 + draw(3));
      const [fleet, run] = [fleetOf(...names.map((name) => [`${name}/birth`, birth("e")])), new StopRun("all", "id", 0)];
      const confirmed = new Set();
      for (let now = 0; now < 3000; now += 50) {
        run.due(fleet, now);
        const name = oneOf(["g", "h", "i"]);
        const stopped = ["x", "y"].filter(() => draw(2) === 0);
        if (draw(3) > 0) continue;
        run.take(name, answer(stopped, ["x", "y"].filter((axis) => !stopped.includes(axis))));
        for (const axis of stopped) confirmed.add(`${name}/${axis}`);
        const isWhole = names.every((one) => ["x", "y"].every((axis) => confirmed.has(`${one}/${axis}`)));
        assert.equal(run.isOver(now), isWhole);
      }
    }
  });

  it("does not take answers of another form", () => {
    for (const wrong of ["", "[]", "{}", '{"result":{}}', '{"result":{"stopped":[{}],"failed":[]}}', '{"result":{"stopped":[{"axis":1}],"failed":[]}}', '{"result":{"stopped":["x"],"failed":[]}}', "{".repeat(100_000)])
      assert.equal(messages.readStopAnswer(bytes(wrong)), null, wrong.slice(0, 50));
    assert.equal(messages.readStopAnswer(bytes(`{"result":{"stopped":[],"failed":[]},"x":"${"x".repeat(1_000_001)}"}`)), null);
  });
});

it("only the lines that are in sight are drawn", () => {
  for (let round = 0; round < 2000; ++round) {
    const [count, height, line] = [draw(10_000), draw(2000), 20 + draw(60)];
    const scrolled = draw(count * line + 1);
    const { first, end } = rows.windowOf(count, scrolled, height, line);
    assert.ok(0 <= first && first <= end && end <= count, `${count} ${scrolled} ${height} ${line}`);
    const inSight = (index) => (index + 1) * line > scrolled && index * line < scrolled + height;
    for (let index = 0; index < count; index += 1 + draw(50)) if (inSight(index)) assert.ok(first <= index && index < end);
    assert.ok(end - first <= Math.ceil(height / line) + 18);
  }
});

describe("the address of the page", () => {
  const { addressWith, brokerAddress, readAddress } = address;
  it("says which broker; a page that a broker serves means that one", () => {
    assert.equal(readAddress(new URL("https://b:9001/")).broker, "wss://b:9001");
    assert.equal(readAddress(new URL("http://b:9001/?broker=")).broker, "ws://b:9001");
    assert.equal(readAddress(new URL("file:///home/anna/fleet.html")).broker, "");
    assert.deepEqual(readAddress(new URL("https://w/fleet.html?broker=wss://b:9&user=anna&gateways=h*")), { broker: "wss://b:9", user: "anna", gateways: "h*" });
  });
  it("keeps what it says", () => {
    const said = { broker: "wss://b:9/mqtt?x=1&y=2", user: "anna", gateways: "hall 3*" };
    assert.deepEqual(readAddress(addressWith(new URL("https://w/fleet.html"), said)), said);
    assert.equal(addressWith(new URL("https://w/?gateways=a&broker=ws://c"), { broker: "ws://c", user: "", gateways: "" }).search, "?broker=ws%3A%2F%2Fc");
  });
  it("has no words of another kind, and no password", () => {
    for (const text of ["", "b", "http://b", "https://b", "javascript:alert(1)", "wss://anna:secret@b", "wss://anna@b", "ws://b#x", "ws://"]) assert.equal(brokerAddress(text), null, text);
    assert.equal(brokerAddress("ws://[::1]:9001/mqtt").host, "[::1]:9001");
  });
});
