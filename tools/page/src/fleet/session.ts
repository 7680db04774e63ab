// The page's part on a broker: what is heard there, what is wished for, and stops. Its view looks at the signals here.
import { signal } from "@preact/signals";
import { BrokerLink } from "./broker_link";
import type { Ending } from "./broker_link";
import { Fleet } from "./fleet";
import { readStopAnswer } from "./messages";
import { repeatMs, StopRun } from "./stop_run";
import { texts } from "./texts";
import * as topics from "./topics";
import { wishExpiryS, Wishes } from "./wishes";

export interface Account {
  address: string;
  user: string;
  /** Empty: a certificate says who it is, or nothing has to. */
  password: string;
}

export type Status = { is: "form"; why: string } | { is: "connecting" } | { is: "open" } | { is: "lost"; why: string };

export const status = signal<Status>({ is: "form", why: "" });
/** Changes when there is something else to draw. */
export const frame = signal(0);
/** Whom the page is; null before the first connection. */
export const account = signal<Account | null>(null);
/** What the broker says against a stop; empty: nothing. */
export const stopRefused = signal("");

export const fleet = new Fleet();
export const runs = new Map<string, StopRun>(); // by scope

const firstRetryMs = 500;
const slowestRetryMs = 5000;
const lookMs = 1000;
/** A broker that is asked for much at once may drop some of it. */
const asksAtOnce = 32;
/** On one connection: some axes have no state, as their module was never there. */
const mostAsks = 3;
/** Stops with QoS 1 that the broker has not acknowledged; above it they go with QoS 0. */
const mostUnacknowledged = 8;
const drawEveryMs = 100;
const reasons = { first: 0x80, notAuthorized: 0x87 };

const wishes = new Wishes();
/** Stops and their answers have a connection of their own: no flood of states keeps them out. */
type Links = { news: BrokerLink; stops: BrokerLink };
let links: Links | null = null;
let wasOpen = false;
let retryMs = firstRetryMs;
let wanted: string[] = [];
let unacknowledged = new Set<number>();
let askedAgain: string[] = [];
let asks = new Map<string, number>(); // by topic
let isDrawDue = false;

const hex = (bytes: Uint8Array) => [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
const drawId = () => hex(crypto.getRandomValues(new Uint8Array(12)));

/** At most ten times a second, and not while the page is hidden. */
function draw(): void {
  if (isDrawDue) return;
  isDrawDue = true;
  setTimeout(() => requestAnimationFrame(() => {
    isDrawDue = false;
    ++frame.value;
  }), drawEveryMs);
}

// ---- the connection

export function connect(to: Account): void {
  disconnect("");
  account.value = to;
  wasOpen = false;
  retryMs = firstRetryMs;
  status.value = { is: "connecting" };
  open();
}

/** Empty: it was asked for. */
export function disconnect(why: string): void {
  takeWishesBack();
  endLinks();
  runs.clear();
  fleet.forget();
  account.value = null;
  status.value = { is: "form", why };
  draw();
}

function open(): void {
  try {
    links = linkedTo(account.peek()!);
  } catch (error) {
    disconnect(texts.addressRefused(error instanceof Error ? error.message : ""));
  }
}

function linkedTo({ address, user, password }: Account): Links {
  const login = () => ({ client: `tmcl-page-${drawId()}`, user, password });
  const events = {
    onOpen: () => links?.news.isOpen && links.stops.isOpen && begin(links),
    onMessage: take,
    onAcknowledged: acknowledge,
    onEnd: (why: Ending) => end(why),
  };
  return { news: new BrokerLink(address, login(), events), stops: new BrokerLink(address, login(), events) };
}

function endLinks(): void {
  links?.news.end();
  links?.stops.end();
  links = null;
}

function begin({ news, stops }: Links): void {
  wasOpen = true;
  retryMs = firstRetryMs;
  wishes.forget();
  fleet.forget();
  unacknowledged = new Set();
  askedAgain = [];
  asks = new Map();
  status.value = { is: "open" };
  stops.subscribe([topics.repliesTo(account.peek()!.user)]);
  news.subscribe([topics.allBirths, topics.allStates]);
  tellWishes();
  tellStops();
  draw();
}

/** One without the other is not what is shown. */
function end(why: Ending): void {
  endLinks();
  const text = texts.endings(why);
  if (!wasOpen) return disconnect(text);
  status.value = { is: "lost", why: text };
  draw();
  setTimeout(() => status.peek().is === "lost" && links === null && open(), retryMs);
  retryMs = Math.min(retryMs * 2, slowestRetryMs);
}

// ---- what is heard

function take(name: string, payload: Uint8Array, retained: boolean): void {
  const topic = topics.read(name);
  if (!topic) ++fleet.misread;
  else if (topic.is === "reply") takeReply(topic, payload, retained);
  else fleet.take(topic, payload);
  draw();
}

/** Those to other questions than the last stops are for another page of this user, or come too late. */
function takeReply(topic: topics.Topic & { is: "reply" }, payload: Uint8Array, retained: boolean): void {
  const run = [...runs.values()].find(({ id }) => id === topic.id);
  if (!run || retained || topic.user !== account.peek()?.user) return;
  const answer = readStopAnswer(payload);
  if (answer) run.take(topic.gateway, answer);
  else ++fleet.misread;
}

/** For what was dropped on the way: the broker tells what it keeps to each new subscription. */
function askAgain(): void {
  links?.news.unsubscribe(askedAgain.splice(0));
  const { births, states } = fleet.incomplete();
  const missing = [...births.map(topics.birthOf), ...states.map(topics.statesOf)];
  askedAgain = missing.filter((topic) => (asks.get(topic) ?? 0) < mostAsks).slice(0, asksAtOnce);
  for (const topic of askedAgain) asks.set(topic, (asks.get(topic) ?? 0) + 1);
  links?.news.subscribe(askedAgain);
}

// ---- wishes

/** Telemetry of these gateways is to come, and of no others. */
export function want(gateways: string[]): void {
  wanted = gateways;
  tellWishes();
}


function tellWishes(): void {
  const link = links?.news;
  if (!link?.isOpen) return;
  const user = account.peek()!.user;
  const isSeen = document.visibilityState === "visible";
  const { wish, end: ended, first } = wishes.due(isSeen ? wanted : [], performance.now());
  link.subscribe([...first.map(topics.telemetryOf)]);
  link.unsubscribe([...ended.map(topics.telemetryOf)]);
  for (const name of wish) link.publish({ topic: topics.wishOf(name, user), payload: "page", retained: true, expiryS: wishExpiryS });
  for (const name of ended) link.publish({ topic: topics.wishOf(name, user), payload: "", retained: true });
}

function takeWishesBack(): void {
  const shown = wanted;
  want([]);
  wanted = shown;
}

// ---- stops

/** Every press goes out, whatever became of those before. `scope`: a gateway, or all. */
export function stop(scope: string): void {
  if (status.peek().is === "form") return;
  for (const [other, run] of runs) if (scope === topics.all || run.isConfirmed()) runs.delete(other);
  stopRefused.value = "";
  const run = new StopRun(scope, drawId(), performance.now());
  run.look(fleet);
  runs.set(scope, run);
  tellStops();
  draw();
}

function tellStops(): void {
  const link = links?.stops;
  if (status.peek().is !== "open" || !link) return;
  for (const run of runs.values()) for (const gateway of run.due(fleet, performance.now())) tellStop(link, run, gateway);
}

function tellStop(link: BrokerLink, run: StopRun, gateway: string): void {
  const responseTopic = topics.replyOf(account.peek()!.user, gateway, run.id);
  const qos = unacknowledged.size < mostUnacknowledged ? 1 : 0;
  const packet = link.publish({ topic: topics.stopOf(gateway), payload: "", qos, responseTopic });
  if (packet > 0) unacknowledged.add(packet);
}

/** Only stops are acknowledged. */
function acknowledge(packet: number, reason: number): void {
  if (!unacknowledged.delete(packet)) return;
  stopRefused.value = reason >= reasons.first ? texts.stopRefused(reason === reasons.notAuthorized, reason) : "";
}

/** What the page does by itself. */
export function start(): void {
  setInterval(() => {
    const isStopping = [...runs.values()].some((run) => !run.isOver(performance.now()));
    tellStops();
    if (isStopping) draw();
  }, repeatMs);
  setInterval(() => {
    tellWishes();
    askAgain();
  }, lookMs);
  document.addEventListener("visibilitychange", tellWishes);
  addEventListener("pagehide", takeWishesBack);
}
