#pragma once

namespace clipgs {

// Of overview_page(). On telephones a row of the table is a card.
inline constexpr const char* kOverviewStyle = R"css(
:root { color-scheme: light dark; --ground: #f6f5f2; --card: #ffffff; --ink: #1d1f23;
  --quiet: #5d6169; --line: #dddbd5; --accent: #1a5fd0; --bad: #b3261e; --odd: #96450f; }
@media (prefers-color-scheme: dark) { :root { --ground: #111316; --card: #1a1d21; --ink: #e8e9eb;
  --quiet: #a3a9b1; --line: #30343a; --accent: #6ea8ff; --bad: #ff8a80; --odd: #f0a35e; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--ground); color: var(--ink);
  font: 16px/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif; }
main { max-width: 1500px; margin: 0 auto; padding: 2rem 1.25rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; letter-spacing: -.01em; }
p { max-width: 72ch; margin: .4rem 0; }
a { color: var(--accent); }
.quiet { color: var(--quiet); } .bad { color: var(--bad); } .odd { color: var(--odd); }
.badge { display: inline-block; border: 1px solid var(--odd); color: var(--odd);
  border-radius: 99px; padding: .05rem .7rem; font-size: .85rem; margin-bottom: .9rem; }
form { display: flex; flex-wrap: wrap; gap: .75rem 1rem; align-items: end; margin: 1.4rem 0 .8rem; }
label { display: grid; gap: .2rem; font-size: .85rem; color: var(--quiet); }
input, select, th button { font: inherit; color: var(--ink); background: var(--card);
  border: 1px solid var(--line); border-radius: 8px; padding: .45rem .7rem; min-height: 44px; }
input { min-width: 16rem; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
.scroll { overflow-x: auto; background: var(--card); border: 1px solid var(--line);
  border-radius: 10px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: .55rem .7rem; text-align: right; vertical-align: top; }
thead > tr > * { padding: 0; border-bottom: 1px solid var(--line); vertical-align: bottom; }
th button { width: 100%; border: 0; border-radius: 0; background: none; font-weight: 600;
  font-size: .85rem; color: var(--quiet); text-align: inherit; cursor: pointer; }
th button:hover { color: var(--ink); }
th[aria-sort=ascending] button::after { content: " ▲"; }
th[aria-sort=descending] button::after { content: " ▼"; }
tbody tr + tr > * { border-top: 1px solid var(--line); }
th.case, tbody th, td.why { text-align: left; }
tbody th { font-weight: 400; min-width: 9rem; } td.why { min-width: 12rem; }
tbody th b { display: block; font-weight: 600; overflow-wrap: anywhere; }
tbody th small, td.why small { display: block; color: var(--quiet); overflow-wrap: anywhere; }
td.why p { margin: 0; overflow-wrap: anywhere; }
td.picture { width: 144px; padding-right: 0; }
td.picture img, td.picture span { width: 128px; height: 96px; display: block; object-fit: contain;
  background: #000; border-radius: 8px; }
td.picture span { background: var(--line); }
dt { font-weight: 600; margin-top: .6rem; } dd { margin: 0; max-width: 72ch; }
@media (max-width: 1100px) {
  td.picture { width: 112px; } td.picture img, td.picture span { width: 96px; height: 72px; }
}
@media (max-width: 900px) {
  main { padding: 1.25rem .75rem 3rem; }
  label, input, select { width: 100%; }
  .scroll { overflow: visible; background: none; border: 0; }
  table, tbody { display: block; }
  thead { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
  tbody tr { display: grid; grid-template-columns: 1fr 1fr; background: var(--card);
    border: 1px solid var(--line); border-radius: 10px; padding: .6rem; margin-bottom: .7rem; }
  tbody tr[hidden] { display: none; }
  tbody tr + tr > * { border: 0; }
  tbody th, td.why { grid-column: 1 / -1; min-width: 0; }
  td.picture { grid-column: 1 / -1; width: auto; padding: .2rem .4rem; }
  td.picture img { width: 100%; height: 180px; } td.picture span, td.none { display: none; }
  td { padding: .2rem .4rem; text-align: left; } tbody th { padding: .2rem .4rem; }
  td[data-label]::before { content: attr(data-label); display: block; font-size: .8rem;
    color: var(--quiet); }
}
)css";

// Sorts and filters the rows that are there; without it they stand as they were written.
inline constexpr const char* kOverviewScript = R"js(
"use strict";
const body = document.querySelector("tbody");
const rows = [...body.rows];
const heads = [...document.querySelectorAll("thead th")];
const form = document.querySelector("form");
const shown = document.querySelector("output");
const collator = new Intl.Collator(undefined, { numeric: true });
form.hidden = false;
if (location.protocol.startsWith("http")) {
  for (const name of document.querySelectorAll("b[data-case]")) {
    const link = document.createElement("a");
    link.href = "../#case=" + encodeURIComponent(name.dataset.case);
    link.append(...name.childNodes);
    name.append(link);
  }
}
function value(row, key) {
  const text = row.dataset[key] ?? "";
  return key === "name" ? text : text === "" ? NaN : Number(text);
}
function sort(key, down) {
  const sign = down ? -1 : 1;
  rows.sort((a, b) => {
    const x = value(a, key);
    const y = value(b, key);
    if (key === "name") return sign * collator.compare(x, y);
    if (isNaN(x) || isNaN(y)) return isNaN(x) - isNaN(y);
    return sign * (x - y);
  });
  body.append(...rows);
  for (const head of heads) {
    if (head.dataset.key === key) head.ariaSort = down ? "descending" : "ascending";
    else head.removeAttribute("aria-sort");
  }
}
function filter() {
  const words = form.elements.words.value.toLocaleLowerCase().split(/\s+/).filter(Boolean);
  const kind = form.elements.kind.value;
  let count = 0;
  for (const row of rows) {
    const text = row.textContent.toLocaleLowerCase();
    row.hidden = !(kind === "" || row.dataset.kind.split(" ").includes(kind)) ||
      !words.every((word) => text.includes(word));
    count += row.hidden ? 0 : 1;
  }
  shown.value = count === rows.length ? `All ${count} shown` : `${count} of ${rows.length} shown`;
}
form.addEventListener("submit", (event) => event.preventDefault());
form.elements.words.addEventListener("input", filter);
form.elements.kind.addEventListener("change", filter);
form.elements.order.addEventListener("change", () => {
  const [key, way] = form.elements.order.value.split(" ");
  sort(key, way === "down");
});
for (const head of heads) {
  head.querySelector("button")?.addEventListener("click", () => {
    const key = head.dataset.key;
    const down = head.ariaSort === "ascending" || (head.ariaSort === null && key !== "name");
    sort(key, down);
    form.elements.order.value = `${key} ${down ? "down" : "up"}`;
  });
}
filter();
)js";

}  // namespace clipgs
