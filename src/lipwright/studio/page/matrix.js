// The matrix of all pairs: who made which, and which are said in the line.

import { arrow, byId, html } from "./drawing.js";

const SOURCES = ["drawn", "fitted", "rule", "imported"];
const MEANINGS = {
  drawn: "drawn by hand",
  fitted: "fitted to captures",
  rule: "made by rule",
  imported: "imported",
  missing: "missing",
};

export function createMatrix({ onChoose }) {
  const root = byId("matrix");
  const cells = new Map();
  let classes = [];
  let view = null;

  const kindOf = (key) => view.status.sources[key] ?? "missing";

  function tell(key) {
    const source = view.status.sources[key];
    const parts = [arrow(key)];
    if (view.inherited.has(key)) parts.push(`the parent's, ${MEANINGS[source]}`);
    else parts.push(MEANINGS[source ?? "missing"]);
    if (view.unsaved.has(key)) parts.push("not saved yet");
    if (view.said.has(key)) parts.push("said in the line");
    byId("about-pair").textContent = parts.join(" · ");
  }

  function build() {
    const names = classes.map((one) => one.name);
    const head = (name, row) => html("span", {
      class: row ? "row-head" : "column-head", role: row ? "rowheader" : "columnheader", text: name });
    root.style.setProperty("--count", names.length);
    const rows = [html("div", { role: "row", class: "row" }, html("span"), ...names.map((n) => head(n, false)))];
    cells.clear();
    for (const first of names) {
      const row = html("div", { role: "row", class: "row" }, head(first, true));
      for (const second of names) {
        const key = `${first} ${second}`;
        const cell = html("button", { type: "button", role: "gridcell", tabindex: -1, "data-pair": key });
        cells.set(key, cell);
        row.append(cell);
      }
      rows.push(row);
    }
    root.replaceChildren(...rows);
  }

  function move(key, down, right) {
    const names = classes.map((one) => one.name);
    const [first, second] = key.split(" ").map((name) => names.indexOf(name));
    const at = (place) => names[Math.min(Math.max(place, 0), names.length - 1)];
    const next = cells.get(`${at(first + down)} ${at(second + right)}`);
    next.focus();
    onChoose(next.dataset.pair);
  }

  const MOVES = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] };
  root.addEventListener("click", (event) => {
    const key = event.target.dataset?.pair;
    if (key) onChoose(key);
  });
  root.addEventListener("keydown", (event) => {
    const key = event.target.dataset?.pair;
    if (!key || !MOVES[event.key]) return;
    event.preventDefault();
    move(key, ...MOVES[event.key]);
  });
  for (const kind of ["pointerover", "focusin"]) {
    root.addEventListener(kind, (event) => {
      const key = event.target.dataset?.pair;
      if (key) tell(key);
    });
  }
  root.addEventListener("pointerleave", () => view && tell(view.chosen));

  function legend(counts) {
    const row = (marks, text) => html("li", {}, html("i", { class: marks }), text);
    const rows = [...SOURCES, "missing"].filter((kind) => counts[kind]).map((kind) =>
      row(`kind-${kind}`, `${MEANINGS[kind]} ${counts[kind]}`));
    if (view.inherited.size) {
      const [one] = view.inherited;
      rows.push(row(`kind-${kindOf(one)} inherited`, `pale: the parent's ${view.inherited.size}`));
    }
    if (view.said.size) rows.push(row("dot", "said in the line"));
    if (view.unsaved.size) rows.push(row("kind-drawn unsaved", `not saved yet ${view.unsaved.size}`));
    byId("legend").replaceChildren(...rows);
  }

  return {
    update({ set, status, motion, chosen }) {
      view = {
        status,
        chosen,
        inherited: new Set(status.inherited),
        unsaved: new Set(status.unsaved),
        said: new Set((motion?.pairs ?? []).map((one) => one.pair)),
      };
      if (classes !== set.classes) {
        classes = set.classes;
        build();
      }
      const counts = {};
      for (const [key, cell] of cells) {
        const kind = kindOf(key);
        counts[kind] = (counts[kind] ?? 0) + 1;
        const marks = [`kind-${kind}`];
        if (view.inherited.has(key)) marks.push("inherited");
        if (view.said.has(key)) marks.push("said");
        if (view.unsaved.has(key)) marks.push("unsaved");
        if (key === chosen) marks.push("chosen");
        const label = marks.join(" ");
        if (cell.className !== label) cell.className = label;
        cell.tabIndex = key === chosen ? 0 : -1;
        cell.setAttribute("aria-selected", key === chosen);
        cell.setAttribute("aria-label", `${arrow(key)}, ${MEANINGS[kind]}${view.inherited.has(key) ? ", the parent's" : ""}`);
      }
      legend(counts);
      tell(chosen);
    },
  };
}
