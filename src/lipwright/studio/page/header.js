// Names, what is saved, and what can be undone.

import { byId } from "./drawing.js";

export function showHeader({ set, status, pair }) {
  byId("set-name").textContent = set.name;
  byId("set-file").textContent = set.parent ? `${set.file}, child of ${set.parent.split("/").at(-1)}` : set.file;
  const count = status.unsaved.length;
  const fresh = status.exists ? "All saved" : "The file is made at the first Save";
  const waiting = status.pending.length ? "Edits of the last time wait" : fresh;
  byId("saved").textContent = count ? `${count} unsaved ${count === 1 ? "pair" : "pairs"}` : waiting;
  byId("save").disabled = !count;
  byId("undo").disabled = !status.undo;
  byId("redo").disabled = !status.redo;
  document.title = `${count ? "• " : ""}${set.name}: phone bigrams`;
  const classes = pair.pair.split(" ").map((name) => set.classes.find((one) => one.name === name));
  byId("pair-title").textContent = classes.map((one) => one.name).join(" → ");
  byId("pair-words").textContent = classes.map((one) => one.examples.slice(0, 2).join(", ") || "no phones").join(" → ");
}
