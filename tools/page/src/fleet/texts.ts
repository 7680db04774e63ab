// All texts of the page of a fleet.
import type { Ending } from "./broker_link";
import type { Counts, Presence } from "./fleet";
import type { Missing, StopReport } from "./stop_run";
import { all } from "./topics";

const gateways = (count: number) => (count === 1 ? "1 gateway" : `${count} gateways`);
const axes = (count: number) => (count === 1 ? "1 axis" : `${count} axes`);

const localStop = "Stop at the machines, or on the page of each gateway.";

const endings: Record<Ending["is"], string> = {
  lost: "The broker cannot be reached, or has ended the connection",
  silent: "The broker does not answer any more",
  no_mqtt: "What answers there is no broker for MQTT 5",
  refused: "The broker refuses the connection",
  ended_by_broker: "The broker has ended the connection",
};

const reasons: Record<number, string> = {
  0x84: "it does not speak MQTT 5",
  0x86: "user name or password are wrong",
  0x87: "user name or password are wrong, or this user may not",
  0x88: "it is not available",
  0x89: "it is busy",
  0x8b: "it shuts down",
  0x8e: "another client has taken the name of this one",
  0x95: "a message was too long",
};
const reasonText = (reason: number) => reasons[reason] ?? `reason 0x${reason.toString(16)}`;

const presences: Record<Presence, string> = { online: "online", away: "away", without_tmcld: "without tmcld" };

function whyText(why: Missing["why"]): string {
  if (why.is === "no_answer") return why.seconds < 1 ? "no answer yet" : `no answer for ${why.seconds} s`;
  if (why.is === "error") return why.message;
  return why.is === "gone" ? `it has left the broker without an answer. ${localStop}` : "its gateway says nothing about it";
}

export const texts = {
  title: "Fleet",
  signIn: "Connect",
  address: "Address of the broker",
  addressHelp: "Its WebSocket, such as wss://broker.example:9001",
  user: "User name",
  userHelp: "As the broker knows it, also where a certificate says it.",
  password: "Password",
  passwordHelp: (host: string) => `Goes to ${host}, and is not kept. Empty where the broker asks for none.`,
  noAddress: "That is no address of a WebSocket: it begins with ws:// or wss://, and has no user name or password in it",
  noUser: "A user name has 1 to 64 letters, digits, '_', '-', '.', '@'",
  addressRefused: (why: string) => `The browser refuses that address: ${why}`,
  connecting: "Connecting ...",
  as: (user: string, host: string) => `${user} · ${host}`,
  leave: "Disconnect",
  endings: (why: Ending) => ("reason" in why ? `${endings[why.is]}: ${reasonText(why.reason)}` : endings[why.is]),
  lost: (why: string) => `${why}. What is shown is old, and a stop does not go out. ${localStop}`,

  stopAll: "Stop all",
  stopAllHelp: "Stops every axis of every gateway, also of those that are not shown. The space bar does it, too.",
  stopOne: "Stop",
  stopGateway: (name: string) => `Stop ${name}`,
  notSent: (why: string) => `NOT STOPPED. ${why}. ${localStop} It goes out if the connection comes back within 30 s.`,
  stopRefused: (isForbidden: boolean, reason: number) =>
    `NOT STOPPED. The broker refuses the stop: ${isForbidden ? "this user may not stop" : reasonText(reason)}. ${localStop}`,
  scopeOf: (scope: string) => (scope === all ? "" : `${scope}: `),
  stopping: (done: number, missing: number) => `Stopping ... ${gateways(done)} confirmed, ${missing} not yet`,
  stopped: ({ done, axes: count }: StopReport) => `Stopped: ${axes(count)} of ${gateways(done.length)}`,
  givenUp: (missing: number) => `NOT STOPPED: ${gateways(missing)}. Asking them has ended after 30 s. ${localStop}`,
  noGateway: "No gateway has answered",
  missing: ({ gateway, axis, why }: Missing) => `${axis === "" ? gateway : `${gateway} ${axis}`}: ${whyText(why)}`,
  more: (count: number) => `and ${count} more`,
  awayNotStopped: (count: number) => `${gateways(count)} away: a stop does not reach what is away.`,

  presences,
  counts: ({ online, away, withoutTmcld }: Counts) =>
    `${gateways(online + away + withoutTmcld)}: ${online} online, ${away} away${withoutTmcld > 0 ? `, ${withoutTmcld} without tmcld` : ""}`,
  axisCounts: ({ axes: count, moving, withFaults }: Counts) => `${axes(count)}: ${moving} moving, ${withFaults} with faults`,
  misread: (count: number) => `${count} messages on the broker were not as gateways write them, and are not shown.`,
  filter: "Gateways",
  filterHelp: "such as hall3-*",
  noneFits: "No gateway has such a name.",
  noGateways: "No gateway is on this broker, or this user may not see one.",
  moves: "This page looks and stops. Moves: on the page of the gateway.",

  table: "Gateways and their axes",
  heads: ["Axis", "Position", "State", "Stopped by", "Moved by"],
  notKnown: "–",
  moving: "moves",
  standing: "stands",
  latched: "latched",
  unattended: "unattended",
  noReference: "no reference",
  confirmed: "stop confirmed",
  notConfirmed: "stop not confirmed",
  microsteps: "µsteps",
};
