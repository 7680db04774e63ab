import { show, shownTab, tabs } from "../tabs";
import { texts } from "../texts";

export function TabBar() {
  return (
    <nav class="tabs" aria-label={texts.parts}>
      {tabs.map((tab) => (
        <button aria-current={shownTab.value === tab ? "page" : undefined} onClick={() => show(tab)}>
          {texts.tabs[tab]}
        </button>
      ))}
    </nav>
  );
}
