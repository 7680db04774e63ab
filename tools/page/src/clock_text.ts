/** "10:12:01.123" of an instant in microseconds since 1970, in UTC. */
export function clockText(utcUs: number): string {
  return new Date(utcUs / 1000).toISOString().slice(11, 23);
}
