import { texts } from "../texts";

export function Modules() {
  return <section aria-label={texts.tabs.modules} />;
}
