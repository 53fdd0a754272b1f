import "./ui/viewer.css";
import "./ui/page.css";

import type { ClipgsApi } from "./api";
import { Page } from "./page";
import { makeApi } from "./script_api";
import { h } from "./ui/dom";

declare global {
  interface Window {
    clipgs: ClipgsApi;
  }
}

const root = document.getElementById("app")!;
try {
  const page = new Page(root);
  const ready = page.start();
  ready.catch(() => {}); // said on the page; who waits for it hears it too
  window.clipgs = makeApi(page.app, () => ready);
} catch (error) {
  root.replaceChildren(h("div", { class: "message", role: "alert" }, h("p", {}, (error as Error).message)));
}
