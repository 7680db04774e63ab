import { useState } from "preact/hooks";
import { addressWith, readAddress } from "../../fleet/address";
import { account, disconnect, fleet, frame, status } from "../../fleet/session";
import { texts } from "../../fleet/texts";
import { GatewayTable } from "./gateway_table";
import { SignIn } from "./sign_in";
import { StopFleet } from "./stop_fleet";

export function FleetApp() {
  const now = status.value;
  if (now.is === "form") return <SignIn why={now.why} />;
  const { user, address } = account.value!;
  return (
    <>
      <header>
        <h1>{texts.title}</h1>
        <span class="who">{texts.as(user, new URL(address).host)}</span>
        <button onClick={() => disconnect("")}>{texts.leave}</button>
        <StopFleet />
      </header>
      <main class={now.is === "open" ? "part" : "part stale"}>
        {now.is === "connecting" && <p class="notice" role="status">{texts.connecting}</p>}
        {now.is === "lost" && <p class="problem loud" role="alert">{texts.lost(now.why)}</p>}
        <Counts />
        <Gateways />
        <p class="help">{texts.moves}</p>
      </main>
    </>
  );
}

function Counts() {
  frame.value;
  const counts = fleet.counts();
  return (
    <>
      <p class="counts">
        <span data-count="gateways">{texts.counts(counts)}</span>
        <span data-count="axes">{texts.axisCounts(counts)}</span>
      </p>
      {fleet.misread > 0 && <p class="problem">{texts.misread(fleet.misread)}</p>}
    </>
  );
}

function Gateways() {
  const [pattern, setPattern] = useState(readAddress(new URL(location.href)).gateways);
  const filter = (text: string) => {
    setPattern(text);
    const page = new URL(location.href);
    history.replaceState(null, "", addressWith(page, { ...readAddress(page), gateways: text }));
  };
  return (
    <>
      <label>
        {texts.filter}
        <input type="search" autocomplete="off" placeholder={texts.filterHelp} value={pattern} onInput={(event) => filter(event.currentTarget.value)} />
      </label>
      <GatewayTable pattern={pattern} />
    </>
  );
}
