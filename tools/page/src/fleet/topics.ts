// The topics of gateways on a broker, as docs/FLEET.md has them. Does no I/O.

const root = "tmcl/v1/";
const level = /^[A-Za-z0-9_.@-]{1,64}$/;
/** Topics of all gateways begin with these. */
const noGateways = ["all", "reply"];
const longestTopic = 256;

/** A user, a gateway or an axis may be called so: no wildcard, no '/'. */
export const isLevel = (text: string) => level.test(text);
export const isGatewayName = (text: string) => isLevel(text) && !noGateways.includes(text);

export type Topic =
  | { is: "birth"; gateway: string }
  | { is: "state" | "telemetry"; gateway: string; axis: string }
  | { is: "reply"; user: string; gateway: string; id: string };

/** Null for what no gateway would write. */
export function read(topic: string): Topic | null {
  if (topic.length > longestTopic || !topic.startsWith(root)) return null;
  const levels = topic.slice(root.length).split("/");
  if (levels.length > 4 || !levels.every(isLevel)) return null;
  const [first = "", second, third, fourth] = levels;
  if (first === "reply") return readReply(second, third, fourth);
  if (!isGatewayName(first)) return null;
  if (levels.length === 2 && second === "birth") return { is: "birth", gateway: first };
  if (levels.length === 3 && (second === "state" || second === "telemetry")) return { is: second, gateway: first, axis: third! };
  return null;
}

function readReply(user?: string, gateway?: string, id?: string): Topic | null {
  if (user === undefined || gateway === undefined || id === undefined || !isGatewayName(gateway)) return null;
  return { is: "reply", user, gateway, id };
}

/** In place of a gateway: for all of them. */
export const all = "all";
export const allBirths = `${root}+/birth`;
export const allStates = `${root}+/state/+`;
export const statesOf = (gateway: string) => `${root}${gateway}/state/+`;
export const birthOf = (gateway: string) => `${root}${gateway}/birth`;
export const telemetryOf = (gateway: string) => `${root}${gateway}/telemetry/+`;
export const wishOf = (gateway: string, user: string) => `${root}${gateway}/want/${user}`;
export const repliesTo = (user: string) => `${root}reply/${user}/+/+`;
/** Of one gateway, or of all. */
export const stopOf = (gateway: string) => `${root}${gateway}/stop`;
export const replyOf = (user: string, gateway: string, id: string) => `${root}reply/${user}/${gateway}/${id}`;
