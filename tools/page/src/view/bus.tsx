import { texts } from "../texts";

export function Bus() {
  return <section aria-label={texts.tabs.bus} />;
}
