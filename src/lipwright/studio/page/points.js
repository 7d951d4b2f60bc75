// The points of one curve as numbers, and what is known of the pair.

import { arrow, byId, html, poseColour, round } from "./drawing.js";

const ABOUT = {
  drawn: "drawn by hand",
  fitted: "fitted to captures",
  rule: "made by rule",
  imported: "imported",
};

export function createPointTable(actions) {
  const root = byId("table");
  let shown = "";

  function change(curves, pose, index, column, input) {
    const value = input.valueAsNumber;
    if (!Number.isFinite(value)) {
      input.value = curves[pose][index][column];
      return;
    }
    const row = curves[pose].map((point) => [...point]);
    row[index][column] = value;
    shown = ""; // what was typed may be refused: then it is drawn again
    actions.commit({ ...curves, [pose]: row });
  }

  function rowOf(pair, pose, point, index) {
    const cell = (column, name) => html("td", {}, html("input", {
      type: "number", step: 0.01, value: round(point[column], 4), "aria-label": `${name} of point ${index + 1}`,
      ...(column ? {} : { min: -0.1, max: 1.1 }),
      onchange: (event) => change(pair.curves, pose, index, column, event.target),
    }));
    const remove = () => {
      const left = pair.curves[pose].filter((_, place) => place !== index);
      const { [pose]: _, ...others } = pair.curves;
      actions.commit(left.length ? { ...pair.curves, [pose]: left } : others);
    };
    return html("tr", {}, html("th", { scope: "row", text: index + 1 }), cell(0, "Time"), cell(1, "Value"),
      html("td", {}, html("button", { type: "button", class: "remove", "aria-label": `Remove point ${index + 1}`, text: "×", onclick: remove })));
  }

  function add(pair, pose) {
    const row = pair.curves[pose];
    const last = row.at(-1);
    const before = row.at(-2) ?? [0, 0];
    const point = [round((before[0] + last[0]) / 2), round((before[1] + last[1]) / 2)];
    actions.commit({ ...pair.curves, [pose]: row.toSpliced(-1, 0, point) });
  }

  return {
    update({ set, pair, pose }) {
      byId("points-title").replaceChildren(html("span", { text: "Points " }),
        pose ? html("small", { class: "of-pose", colour: poseColour(set.poses, pose), text: pose }) : "");
      const row = pose ? pair.curves[pose] : undefined;
      const now = JSON.stringify([pair.pair, pose, row]);
      if (now === shown) return;
      shown = now;
      if (!row) {
        root.replaceChildren(html("p", { class: "quiet", text: "Choose a pose above the curves, or add one." }));
        return;
      }
      const held = root.contains(document.activeElement) ? document.activeElement.getAttribute("aria-label") : null;
      root.replaceChildren(
        html("div", { class: "scroll" }, html("table", {},
          html("thead", {}, html("tr", {}, html("th"), html("th", { scope: "col", text: "time" }), html("th", { scope: "col", text: "value" }), html("th"))),
          html("tbody", {}, ...row.map((point, index) => rowOf(pair, pose, point, index))))),
        html("button", { type: "button", text: "Add a point", onclick: () => add(pair, pose) }));
      if (held) root.querySelector(`[aria-label="${held}"]`)?.focus();
    },
  };
}

export function createFacts(actions) {
  const root = byId("facts");
  let shown = "";
  return {
    update({ pair, pose, status }) {
      const now = JSON.stringify([pair.pair, pair.missing, pair.source, pair.note, pair.own, pair.count, pair.variance[pose], status.unsaved.includes(pair.pair)]);
      if (now === shown || root.contains(document.activeElement)) return;
      shown = now;
      const rows = [];
      const whose = pair.missing ? (pair.stand_in ? `missing; ${arrow(pair.stand_in)} stands in` : "missing; every pose rests")
        : `${ABOUT[pair.source]}${pair.own || !pair.has_inherited ? "" : ", the parent's"}`;
      rows.push(["source", whose]);
      if (pair.count) rows.push(["heard", `${pair.count} times`]);
      if (pose && pair.variance[pose] !== undefined) {
        rows.push(["spread", `${Math.sqrt(pair.variance[pose]).toFixed(2)} of a full pose`]);
      }
      const note = html("input", { type: "text", maxlength: 500, value: pair.note, placeholder: "a note for the next animator",
        "aria-label": "Note", onchange: (event) => actions.note(event.target.value) });
      const list = html("dl", {}, ...rows.flatMap(([name, text]) => [html("dt", { text: name }), html("dd", { text })]),
        html("dt", { text: "note" }), html("dd", {}, note));
      const buttons = [];
      if (pair.own) {
        buttons.push(html("button", { type: "button", onclick: actions.revert,
          text: pair.has_inherited ? "Back to the parent's" : "Remove the pair" }));
      }
      if (pair.missing && pair.stand_in) {
        buttons.push(html("button", { type: "button", onclick: () => actions.beginWith(pair.stand_in),
          text: `Begin with the curves of ${arrow(pair.stand_in)}` }));
      }
      root.replaceChildren(list, ...buttons);
    },
  };
}
