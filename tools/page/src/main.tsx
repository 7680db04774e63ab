import { render } from "preact";
import { watchAxes } from "./bench";
import { enter } from "./access";
import { startScope } from "./scope";
import { App } from "./view/app";
import "./style.css";

render(<App />, document.getElementById("page")!);
void enter(); // before anything changes the address
watchAxes();
startScope();
