import { texts } from "../texts";

export function Profiles() {
  return <section aria-label={texts.tabs.profiles} />;
}
