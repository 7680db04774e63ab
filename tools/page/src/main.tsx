import { render } from "preact";
import { watchAxes } from "./bench";
import { findOutWho } from "./access";
import { startScope } from "./scope";
import { App } from "./view/app";
import "./style.css";

render(<App />, document.getElementById("page")!);
watchAxes();
startScope();
void findOutWho();
