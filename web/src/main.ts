import "./ui/style.css";

import { makeApi } from "./api";
import { App } from "./app";

const app = new App(document.getElementById("app")!);
const ready = app.start();
ready.catch(() => {}); // said on the page; who waits for it hears it too
window.clipgs = makeApi(app, ready);
