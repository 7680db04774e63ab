import { access, may, signOut } from "../access";
import { axes, isConnected } from "../bench";
import { shownTab } from "../tabs";
import { texts } from "../texts";
import { isOutdated } from "../version";
import { AxisCard } from "./axis_card";
import { JogSettings } from "./jog_buttons";
import { Part } from "./part";
import { Scope } from "./scope";
import { SignIn } from "./sign_in";
import { StopAll } from "./stop_all_button";
import { TabBar } from "./tab_bar";

export function App() {
  const now = access.value;
  if (now.is === "unknown") return <p class="notice">{texts.asking}</p>;
  if (now.is === "out") return <SignIn why={now.why} />;
  return (
    <>
      <header>
        <h1>{texts.title}</h1>
        {now.is === "in" && <span class="who">{texts.as(now.token, now.role)}</span>}
        {now.is === "in" && now.signedIn && <button onClick={() => void signOut()}>{texts.signOut}</button>}
        {now.is === "ended" && <button onClick={() => void signOut()}>{texts.signInAgain}</button>}
        <StopAll />
      </header>
      <main class={isConnected.value ? "" : "stale"}>
        {!isConnected.value && may("subscribe") && <p class="notice" role="status">{texts.connecting}</p>}
        {isOutdated.value && <p class="problem" role="alert">{texts.outdated}</p>}
        {now.is === "in" && !may("subscribe") && <p class="notice">{texts.mayOnlyStop}</p>}
        {may("subscribe") && <TabBar />}
        {shownTab.value === "axes" ? <Axes /> : <Part key={shownTab.value} tab={shownTab.value} />}
      </main>
    </>
  );
}

function Axes() {
  return (
    <>
      <JogSettings />
      {isConnected.value && axes.value.length === 0 && <p class="notice">{texts.noAxes}</p>}
      <div class="cards">
        {axes.value.map((axis) => (
          <AxisCard key={axis.info.name} axis={axis} />
        ))}
      </div>
      {may("subscribe") && <Scope />}
    </>
  );
}
