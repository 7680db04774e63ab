// The ramp generators that the page compares, each as a module that has one is set: names, ranges and units are those of docs/PARAMETERS.md.

export interface Register {
  parameter: string;
  /** Of the parameter of a module; null of a chip that is in none. */
  number: number | null;
  /** As the data sheet of the chip calls it. */
  name: string;
  unit: string;
  least: number;
  /** Of the slider; tmcld says what a module takes. */
  most: number;
  value: number;
}

export interface Chip {
  name: string;
  /** The module that is simulated, or the chip itself where it is in none. */
  model: string;
  /** Modules with the same parameters. */
  models: string[];
  /** In the order in which they are set. */
  registers: Register[];
}

const register = (
  parameter: string,
  number: number | null,
  name: string,
  unit: string,
  most: number,
  value: number,
  least = 0,
): Register => ({ parameter, number, name, unit, least, most, value });

const internal = "internal";
const exponent = "2^n";

export const chips: Chip[] = [
  {
    name: "TMC429",
    model: "TMCM-1110",
    models: [
      "TMCM-351", "TMCM-610", "TMCM-1110", "TMCM-1140", "TMCM-1141", "TMCM-1160", "TMCM-1161", "TMCM-3110",
      "TMCM-6110",
    ],
    registers: [
      register("pulse_divisor", 154, "PULSE_DIV", exponent, 13, 3),
      register("ramp_divisor", 153, "RAMP_DIV", exponent, 13, 7),
      register("max_velocity", 4, "V_MAX", internal, 2047, 1000),
      register("max_acceleration", 5, "A_MAX", internal, 2047, 500),
    ],
  },
  {
    name: "TMC457",
    model: "TMCM-142",
    models: ["TMCM-142", "PD-146"],
    registers: [
      register("max_velocity", 4, "V_MAX", internal, 10_000_000, 3_000_000),
      register("acceleration", 16, "A_MAX", internal, 30_000, 3000),
      register("max_deceleration", 17, "D_MAX", internal, 30_000, 3000),
      register("max_bow", 18, "BOW_MAX", "2^(n-1)", 18, 4),
    ],
  },
  {
    name: "sixPoint",
    model: "TMCM-6212",
    models: [
      "TMCM-1210", "TMCM-1211", "TMCM-1240", "TMCM-1241", "TMCM-1260", "TMCM-1270", "TMCM-1276", "TMCM-1278",
      "TMCM-3216", "TMCM-6212", "TMCM-6214",
    ],
    registers: [
      register("max_velocity", 4, "VMAX", "pps", 200_000, 50_000),
      register("max_acceleration", 5, "AMAX", "pps/s", 1_000_000, 200_000),
      register("max_deceleration", 17, "DMAX", "pps/s", 1_000_000, 200_000),
      register("acceleration_a1", 15, "A1", "pps/s", 1_000_000, 100_000),
      register("velocity_v1", 16, "V1", "pps", 200_000, 20_000),
      register("deceleration_d1", 18, "D1", "pps/s", 1_000_000, 100_000),
    ],
  },
  {
    name: "MC1451A",
    model: "MC1451A",
    models: [],
    registers: [
      register("cycle_us", null, "Cycle", "µs", 5000, 1000, 1),
      register("velocity", null, "Velocity", "2^-16 steps/cycle", 13_107_200, 3_276_800),
      register("acceleration", null, "Acceleration", "2^-16 steps/cycle²", 32_767, 13_107),
      register("jerk", null, "Jerk", "2^-32 steps/cycle³", 42_949_673, 8_589_935),
    ],
  },
];
