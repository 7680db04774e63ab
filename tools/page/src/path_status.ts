// The paths that tmcld passes, whichever client has begun them.
import { signal } from "@preact/signals";
import { call, isConnected } from "./bench";
import type { Answer } from "./rpc";

export type PathStatus = Answer<"path.status">["paths"][number];

export const paths = signal<PathStatus[]>([]);

const intervalMs = 200;

/** Asks again and again, until the function that it gives is called. */
export function watchPaths(): () => void {
  let isOver = false;
  let timer: number | undefined;
  const look = async () => {
    if (isConnected.peek()) await ask();
    if (!isOver) timer = window.setTimeout(look, intervalMs);
  };
  void look();
  return () => {
    isOver = true;
    clearTimeout(timer);
  };
}

async function ask(): Promise<void> {
  try {
    paths.value = (await call("path.status", {})).paths;
  } catch {
    // The page says so itself when the connection is lost.
  }
}
