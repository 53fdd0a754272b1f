import "./ui/style.css";

import { makeApi } from "./api";
import { App } from "./app";
import { h } from "./ui/dom";

const root = document.getElementById("app")!;
try {
  const app = new App(root);
  const ready = app.start();
  ready.catch(() => {}); // said on the page; who waits for it hears it too
  window.clipgs = makeApi(app, ready);
} catch (error) {
  root.replaceChildren(h("div", { class: "message", role: "alert" }, h("p", {}, (error as Error).message)));
}
