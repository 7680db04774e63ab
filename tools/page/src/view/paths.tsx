import { texts } from "../texts";

export function Paths() {
  return <section aria-label={texts.tabs.paths} />;
}
