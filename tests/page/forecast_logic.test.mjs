// When the scope foresees a move, without a browser.
import assert from "node:assert/strict";
import { afterEach, describe, it } from "node:test";
import { forecastModule } from "./sources.mjs";

const { followState, forecasts, forgetForecasts } = await forecastModule("forecast_logic_sources.js");

globalThis.callOfPage = async (method) =>
  method === "axis.get_ramp"
    ? { model: "TMCM-3110", settings: [] }
    : { curve: { times_s: [0, 1, 2], positions_microsteps: [0, 50, 100], velocities_pps: [0, 100, 0] } };

// In the order in which tmcld reads them, one after the other.
const order = ["position_reached", "velocity_internal", "target_microsteps", "position_microsteps"];
const resting = { position_reached: true, velocity_internal: 0, target_microsteps: 0, position_microsteps: 0 };
const setOut = { ...resting, position_reached: false, target_microsteps: 100 };
const moving = { ...setOut, velocity_internal: 5, position_microsteps: 7 };

let now = 0;
const told = (values) => {
  now += 20;
  const units = { unit: null, position: null, target: null };
  return { axis: "x", event_time_ms: now, moving: values.velocity_internal !== 0, ...units, ...values };
};
/** The first `count` values of one state, and the others of a later one. */
const torn = (count, before, after) => Object.fromEntries(order.map((name, index) => [name, (index < count ? before : after)[name]]));

/** How often a move is foreseen where these states are told. */
async function foreseenBy(states) {
  let count = 0;
  for (const values of states) followState(told(values), () => ++count);
  await new Promise((done) => setImmediate(done));
  return count;
}

describe("a move is foreseen once", () => {
  afterEach(forgetForecasts);

  for (let count = 0; count <= order.length; ++count) {
    for (const [how, after] of [["has not moved yet", setOut], ["moves at once", moving]]) {
      it(`where it begins behind ${count} values of a reading, and ${how}`, async () => {
        const states = [resting, resting, torn(count, resting, after), ...Array(100).fill(moving)];
        assert.equal(await foreseenBy(states), 1);
        assert.equal(forecasts.get("x").targetMicrosteps, 100);
      });
    }
  }

  it("and not where it stands", async () => {
    assert.equal(await foreseenBy([resting, ...Array(100).fill({ ...setOut, position_reached: true, position_microsteps: 100 })]), 0);
  });

  it("and not where it turns without a target", async () => {
    assert.equal(await foreseenBy([resting, ...Array(100).fill({ ...moving, target_microsteps: 0 })]), 0);
  });
});
