// tmcld may have been updated while this page was open: what it serves is another page then.
import { signal } from "@preact/signals";

/** Reloading has not helped. */
export const isOutdated = signal(false);

// The build names a script after its content.
const ownScript = new URL(import.meta.url).pathname;
const reloadedFrom = "reloaded_from";

/** Reloads this page, once, if tmcld has another one. */
export async function takeNewPage(): Promise<void> {
  const response = await fetch("/", { cache: "no-store" }).catch(() => null);
  const text = response?.ok ? await response.text().catch(() => null) : null;
  isOutdated.value = false;
  if (text === null || text.includes(ownScript)) return;
  if (wasReloaded()) isOutdated.value = true;
  else location.reload();
}

/** Where nothing can be stored, a person reloads it. */
function wasReloaded(): boolean {
  try {
    const was = sessionStorage.getItem(reloadedFrom) === ownScript;
    sessionStorage.setItem(reloadedFrom, ownScript);
    return was;
  } catch {
    return true;
  }
}
