// Of which gateways telemetry is wished for. A wish ends by itself: a page that is gone asks for nothing. Does no I/O.

export const wishExpiryS = 60;
const renewMs = 20_000;

export class Wishes {
  #told = new Map<string, number>(); // when, by gateway

  /** What is to be said now, so that telemetry comes of these gateways and of no others. */
  due(wanted: string[], now: number): { wish: string[]; end: string[]; first: string[] } {
    const end = [...this.#told.keys()].filter((name) => !wanted.includes(name));
    const first = wanted.filter((name) => !this.#told.has(name));
    const wish = wanted.filter((name) => now - (this.#told.get(name) ?? -Infinity) >= renewMs);
    for (const name of end) this.#told.delete(name);
    for (const name of wish) this.#told.set(name, now);
    return { wish, end, first };
  }
  /** Another connection begins. */
  forget(): void {
    this.#told.clear();
  }
}
