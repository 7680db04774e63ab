// Which part of the page is shown. The address has it, so that it can be kept and passed on.
import { signal } from "@preact/signals";

export const tabs = ["axes", "paths", "profiles", "modules", "bus"] as const;
export type Tab = (typeof tabs)[number];

export const shownTab = signal<Tab>(tabOf(new URLSearchParams(location.search).get("tab")));

function tabOf(word: string | null): Tab {
  return tabs.find((tab) => tab === word) ?? "axes";
}

export function show(tab: Tab): void {
  shownTab.value = tab;
  const address = new URL(location.href);
  if (tab === "axes") address.searchParams.delete("tab");
  else address.searchParams.set("tab", tab);
  history.replaceState(null, "", address);
}
