import { render } from "preact";
import { watchAxes } from "./bench";
import { enter } from "./access";
import { startScope } from "./scope";
import { App } from "./view/app";
import "./style.css";

function start(): void {
  render(<App />, document.getElementById("page")!);
  void enter(); // before anything changes the address
  watchAxes();
  startScope();
}

// Gateways on a broker have a page of their own.
if (new URLSearchParams(location.search).has("broker")) location.replace(`fleet.html${location.search}`);
else start();
