// Calls to tmcld: single ones by POST, and a WebSocket for what belongs to one client, such as leases and subscriptions.
import type { Methods } from "./methods";
import { texts } from "./texts";

export type Params<M extends keyof Methods> = Methods[M]["params"];
export type Answer<M extends keyof Methods> = Methods[M]["result"];

/** Of what a call handed over. */
export type Problem = { line: number; column: number; message: string };

type ErrorData = { name?: string; hint?: string | null; param?: string; problems?: Problem[]; file_axis?: string | number; run?: Answer<"path.run"> };

/** What tmcld says against a call; `name` is to branch on. */
export class CallError extends Error {
  constructor(
    message: string,
    readonly name: string,
    readonly hint: string | null = null,
    readonly data: ErrorData = {},
  ) {
    super(message);
  }

  static of(error: { message: string; data?: ErrorData }): CallError {
    return new CallError(error.message, error.data?.name ?? "", error.data?.hint ?? null, error.data ?? {});
  }
  /** For a person. */
  get text(): string {
    return this.hint ? `${this.message}. ${this.hint}` : this.message;
  }
}

export function textOf(error: unknown): string {
  return error instanceof CallError ? error.text : String(error);
}

/** One call that waits for no other one. */
export async function post<M extends keyof Methods>(method: M, params: Params<M>, timeoutMs: number): Promise<Answer<M>> {
  const answer = await answerTo(JSON.stringify({ jsonrpc: "2.0", id: 1, method, params }), timeoutMs);
  if (answer.error) throw CallError.of(answer.error);
  return answer.result;
}

async function answerTo(body: string, timeoutMs: number) {
  try {
    const headers = { "Content-Type": "application/json" };
    const signal = AbortSignal.timeout(timeoutMs);
    const response = await fetch("/rpc", { method: "POST", headers, body, keepalive: true, signal });
    return await response.json();
  } catch {
    throw new CallError(texts.notReachable, "not_reachable");
  }
}

type Waiting = { resolve: (result: never) => void; reject: (error: CallError) => void };

/** A WebSocket: one client of tmcld for as long as it is open. */
export class Connection {
  onOpen = () => {};
  onClose = () => {};
  onNotification = (_method: string, _params: never) => {};
  #socket: WebSocket;
  #lastId = 0;
  #isOver = false;
  #waiting = new Map<number, Waiting>();

  constructor() {
    const url = new URL("/ws", location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    this.#socket = new WebSocket(url, ["tmcl"]);
    this.#socket.onmessage = (event) => this.#take(event.data);
    this.#socket.onclose = () => this.#end();
  }

  call<M extends keyof Methods>(method: M, params: Params<M>): Promise<Answer<M>> {
    const id = ++this.#lastId;
    return new Promise((resolve, reject) => {
      if (this.#socket.readyState !== WebSocket.OPEN) {
        reject(new CallError(texts.notConnected, "not_connected"));
        return;
      }
      this.#waiting.set(id, { resolve: resolve as Waiting["resolve"], reject });
      this.#socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
    });
  }

  /** At once: a connection that was cut would take its time to close. */
  end(): void {
    this.#socket.onmessage = null;
    this.#socket.close();
    this.#end();
  }

  #take(text: string): void {
    const message = JSON.parse(text);
    // The greeting comes first: now there is a client.
    if (message.method === "hello") this.onOpen();
    else if (message.method) this.onNotification(message.method, message.params as never);
    else this.#settle(message);
  }

  #settle(message: { id: number; result?: unknown; error?: { message: string } }): void {
    const waiting = this.#waiting.get(message.id);
    this.#waiting.delete(message.id);
    if (message.error) waiting?.reject(CallError.of(message.error));
    else waiting?.resolve(message.result as never);
  }

  #end(): void {
    if (this.#isOver) return;
    this.#isOver = true;
    for (const waiting of this.#waiting.values()) waiting.reject(new CallError(texts.connectionLost, "connection_lost"));
    this.#waiting.clear();
    this.onClose();
  }
}
