import "./ui/viewer.css";
import "./ui/page.css";

import type { ClipgsApi } from "./api";
import { caseFile, fetchIndex } from "./model/case_list";
import { chooseLanguage } from "./text/text";
import { h } from "./ui/dom";
import { CaseClient } from "./worker/case_client";

declare global {
  interface Window {
    clipgs: ClipgsApi;
  }
}

// The case is fetched and decoded while the rest of the viewer's code is on its way.
const client = new CaseClient();
const index = fetchIndex();
index.catch(() => {}); // said by the page

/** The case that the address names (parseLink() would bring most of the viewer's code), or else the first one. */
async function expectCase(): Promise<void> {
  if (new URLSearchParams(location.search).has("study")) {
    return; // its plan says which case
  }
  const linked = new URLSearchParams(location.hash.slice(1)).get("case");
  const file = linked ? caseFile(linked) : (await index).cases.find((one) => !one.error)?.file;
  if (file) {
    client.expect(file);
  }
}

expectCase().catch(() => {}); // said by the page
const root = document.getElementById("app")!;
const asked = new URLSearchParams(location.search).get("lang");
document.documentElement.lang = chooseLanguage([asked, ...navigator.languages]);
try {
  const { startPage } = await import("./page");
  window.clipgs = startPage(root, client, index);
} catch (error) {
  client.dispose();
  root.replaceChildren(h("div", { class: "message", role: "alert" }, h("p", {}, (error as Error).message)));
}
