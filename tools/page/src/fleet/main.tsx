import { render } from "preact";
import { start } from "./session";
import { FleetApp } from "../view/fleet/app";
import "../style.css";
import "./fleet.css";

const page = document.getElementById("page")!;
page.replaceChildren();
render(<FleetApp />, page);
start();
