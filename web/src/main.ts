import "./ui/viewer.css";
import "./ui/page.css";

import type { ClipgsApi } from "./api";
import { caseFile, fetchIndex } from "./model/case_list";
import { inOwnWords, language, languageOf, speak, texts } from "./text/text";
import { h } from "./ui/dom";
import { LoadingCard } from "./ui/loading_card";
import { ViewerTheme } from "./ui/theme";
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
const root = document.getElementById("app")!;
const asked = new URLSearchParams(location.search).get("lang");
if (languageOf([asked, ...navigator.languages]) === "de") {
  await import("./text/de").then(
    ({ german }) => speak("de", german),
    () => {}, // English is there
  );
}
document.documentElement.lang = language();
const loading = showShell();

/** What the page begins with, in the language and the colours that are wanted. */
function showShell(): LoadingCard {
  const card = new LoadingCard();
  card.begin("", false); // it is not known yet what
  root.classList.remove("shell");
  root.classList.toggle("light", new ViewerTheme().shown.value === "light");
  root.querySelector(".warning")!.textContent = texts().notForDiagnosis;
  root.querySelector(".loading")!.replaceWith(card.element);
  return card;
}

/** The case that the address names (parseLink() would bring most of the viewer's code), or else the first one. */
async function expectCase(): Promise<void> {
  if (new URLSearchParams(location.search).has("study")) {
    return; // its plan says which case
  }
  const linked = new URLSearchParams(location.hash.slice(1)).get("case");
  const expect = (file: string): void => {
    loading.begin(file, false);
    client.expect(file, loading);
  };
  if (linked) {
    expect(caseFile(linked));
  }
  const { cases } = await index;
  const known = cases.find((one) => (linked ? one.name === linked : !one.error));
  if (!linked && known) {
    expect(known.file);
  }
  if (known) {
    loading.name(known);
  }
}

expectCase().catch(() => {}); // said by the page
try {
  const { startPage } = await import("./page");
  root.replaceChildren();
  window.clipgs = startPage(root, client, index, loading);
} catch (error) {
  client.dispose();
  root.replaceChildren(
    h("div", { class: "message", role: "alert" }, h("p", {}, inOwnWords((error as Error).message))),
  );
}
