// As whom tmcld has let this page in.
import { signal } from "@preact/signals";
import { roleFor, type Methods, type Role } from "./methods";
import { texts } from "./texts";

export type Access =
  | { is: "unknown" } // tmcld was not asked yet
  | { is: "out"; why: string } // it was not let in yet
  | { is: "in"; role: Role; token: string; signedIn: boolean }
  | { is: "ended"; why: string }; // it was in

export const access = signal<Access>({ is: "unknown" });

const roles: Role[] = ["stop", "observe", "operate", "configure"];

/** What a client may not do is not offered to it. */
export function may(method: keyof Methods): boolean {
  const now = access.value;
  return now.is === "in" && roles.indexOf(now.role) >= roles.indexOf(roleFor[method]);
}

type Who = { role: Role; token: string; signed_in: boolean };

function letIn(who: Who): void {
  access.value = { is: "in", role: who.role, token: who.token, signedIn: who.signed_in };
}

const askAgainMs = 1000;

/** Asks tmcld; changes nothing where it cannot be reached. */
export async function findOutWho(): Promise<void> {
  const response = await fetch("/session").catch(() => null);
  if (response === null) {
    if (access.peek().is === "unknown") setTimeout(findOutWho, askAgainMs);
    return;
  }
  const answer = await response.json().catch(() => null);
  if (response.ok) letIn(answer as Who);
  else refuse(answer?.error?.message ?? "", answer?.error?.data?.name ?? "");
}

/** tmcld lets the page in no more, or has never done so. */
export function refuse(message: string, name: string): void {
  const was = access.value.is;
  if (was === "in" || was === "ended") access.value = { is: "ended", why: message };
  else access.value = { is: "out", why: name === "no_token" ? "" : message };
}

const codeMark = "#code=";

/** At first. A link from `tmclctl page --phone` has a code that signs in once. */
export async function enter(): Promise<void> {
  if (!location.hash.startsWith(codeMark)) return findOutWho();
  const code = location.hash.slice(codeMark.length);
  history.replaceState(null, "", location.pathname + location.search);
  const problem = await signIn(code);
  if (problem) await findOutWho();
  if (problem && access.peek().is === "out") access.value = { is: "out", why: texts.codeRefused };
}

/** Empty, or why not. */
export async function signIn(token: string): Promise<string> {
  const response = await fetch("/session", { method: "POST", headers: { Authorization: `Bearer ${token}` } }).catch(() => null);
  if (response === null) return texts.notReachable;
  const answer = await response.json().catch(() => null);
  if (!response.ok) return answer?.error?.message ?? texts.notReachable;
  letIn(answer as Who);
  return "";
}

/** Forgets the cookie; asks then whether the page is let in without one. */
export async function signOut(): Promise<void> {
  await fetch("/session", { method: "DELETE" }).catch(() => null);
  access.value = { is: "unknown" };
  await findOutWho();
}
