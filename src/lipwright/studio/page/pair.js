// The curves of one pair over normalised time: control polygons and the smooth curves they make.

import { byId, clamp, evenPath, html, poseColour, round, svg, valueAt, whenSized } from "./drawing.js";

const MARGIN = { left: 40, right: 16, top: 14, bottom: 26 };
const SNAP = 7; // pixels to 0, to 1 and to rest
const STEP = 0.01; // of an arrow key; five of them with Shift
const IDLE = 500; // ms after the last arrow key that make an edit
const NEW_CURVE = [[0, 0], [0.3, 0.5], [0.7, 0.5], [1, 0]];

export function createPairEditor(actions) {
  const root = byId("curves");
  const drawing = svg("svg", { role: "group", "aria-label": "Curves of the pair" });
  root.append(drawing);
  let view = null; // {set, pair, pose, boundary, playhead}
  let size = { width: 0, height: 0 };
  let range = [0, 1];
  let drag = null; // {pose, index, moved}
  let timer = 0;

  const x = (time) => MARGIN.left + time * (size.width - MARGIN.left - MARGIN.right);
  const y = (value) => size.height - MARGIN.bottom
    - ((value - range[0]) / (range[1] - range[0])) * (size.height - MARGIN.top - MARGIN.bottom);
  const timeAt = (px) => (px - MARGIN.left) / (size.width - MARGIN.left - MARGIN.right);
  const valueOf = (py) => range[0]
    + ((size.height - MARGIN.bottom - py) / (size.height - MARGIN.top - MARGIN.bottom)) * (range[1] - range[0]);
  const place = (event) => {
    const box = drawing.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const points = (pose) => view.pair.curves[pose];

  function snapped(px, py) {
    let [time, value] = [timeAt(px), valueOf(py)];
    if (Math.abs(px - x(0)) < SNAP) time = 0;
    if (Math.abs(px - x(1)) < SNAP) time = 1;
    for (const level of [0, 1]) if (Math.abs(py - y(level)) < SNAP) value = level;
    return [time, value];
  }

  // A point may go as far as its neighbours, and not out of the pair.
  function within(pose, index, time, value) {
    const row = points(pose);
    const low = index ? row[index - 1][0] : Math.min(0, row[index][0]);
    const high = index + 1 < row.length ? row[index + 1][0] : Math.max(1, row[index][0]);
    return [round(clamp(time, low, high)), round(clamp(value, ...range))];
  }

  function moved(pose, index, time, value) {
    const row = points(pose).map((point) => [...point]);
    row[index] = within(pose, index, time, value);
    return { ...view.pair.curves, [pose]: row };
  }

  function without(pose, index) {
    const { [pose]: row, ...others } = view.pair.curves;
    const left = row.filter((_, place) => place !== index);
    return left.length ? { ...view.pair.curves, [pose]: left } : others;
  }

  function axes() {
    const parts = [];
    const steps = range[1] - range[0] > 1.8 ? 0.5 : 0.25;
    for (let value = Math.ceil(range[0] / steps) * steps; value <= range[1] + 1e-9; value += steps) {
      parts.push(svg("line", { class: Math.abs(value) < 1e-9 ? "axis" : "grid", x1: x(0), x2: x(1), y1: y(value), y2: y(value) }));
      parts.push(svg("text", { class: "tick", x: x(0) - 8, y: y(value) + 4, "text-anchor": "end", text: round(value, 2) }));
    }
    for (const time of [0, 0.25, 0.5, 0.75, 1]) {
      parts.push(svg("line", { class: "grid", x1: x(time), x2: x(time), y1: y(range[0]), y2: y(range[1]) }));
      parts.push(svg("text", { class: "tick", x: x(time), y: size.height - 8, "text-anchor": "middle", text: time }));
    }
    const [first, second] = view.pair.pair.split(" ");
    const edge = x(view.boundary);
    parts.push(svg("rect", { class: "second-phone", x: edge, y: MARGIN.top, width: x(1) - edge, height: y(range[0]) - MARGIN.top }));
    parts.push(svg("line", { class: "edge", x1: edge, x2: edge, y1: MARGIN.top, y2: y(range[0]) }));
    parts.push(svg("text", { class: "phone-name", x: (x(0) + edge) / 2, y: MARGIN.top + 22, "text-anchor": "middle", text: first }));
    parts.push(svg("text", { class: "phone-name", x: (edge + x(1)) / 2, y: MARGIN.top + 22, "text-anchor": "middle", text: second }));
    return parts;
  }

  function curve(pose) {
    const colour = poseColour(view.set.poses, pose);
    const row = points(pose);
    const chosen = pose === view.pose;
    const polygon = row.map(([t, v]) => `${x(t).toFixed(1)},${y(v).toFixed(1)}`).join(" ");
    const group = svg("g", { class: chosen ? "curve chosen" : "curve", colour, "data-pose": pose },
      svg("polyline", { class: "polygon", points: polygon }));
    const dense = view.pair.dense[pose];
    if (dense) {
      const path = evenPath(dense, x(0), x(1), y);
      group.append(svg("path", { class: "spline", d: path }));
      group.append(svg("path", { class: "reach", d: path, "data-reach": pose }));
    }
    row.forEach(([time, value], index) => group.append(svg("circle", {
      class: "point", cx: x(time), cy: y(value), r: chosen ? 6.5 : 4,
      "data-pose": pose, "data-index": index, tabindex: chosen ? 0 : -1, role: "slider",
      "aria-label": `${pose}, point ${index + 1}`, "aria-valuenow": value,
      "aria-valuetext": `time ${round(time)}, value ${round(value)}`,
    })));
    return group;
  }

  function findRange() {
    const values = Object.values(view.pair.curves).flat().map(([, value]) => value);
    return [Math.min(-0.05, ...values.map((v) => v - 0.03)), Math.max(1.1, ...values.map((v) => v + 0.05))];
  }

  function draw() {
    if (!view || !size.width) return;
    const focused = document.activeElement?.dataset;
    const again = drawing.contains(document.activeElement) && focused?.index !== undefined
      ? [focused.pose, focused.index] : null;
    if (!drag) range = findRange();
    drawing.setAttribute("viewBox", `0 0 ${size.width} ${size.height}`);
    const names = Object.keys(view.pair.curves).sort((a, b) => (a === view.pose) - (b === view.pose));
    const parts = [...axes(), ...names.map(curve)];
    if (view.playhead !== null) {
      parts.push(svg("line", { class: "playhead", x1: x(view.playhead), x2: x(view.playhead), y1: MARGIN.top, y2: y(range[0]) }));
    }
    if (!names.length) {
      const text = view.pair.missing ? "No curves yet: double-click to draw the first" : "Every pose rests here; double-click to draw";
      parts.push(svg("text", { class: "empty", x: size.width / 2, y: size.height / 2, "text-anchor": "middle", text }));
    }
    drawing.replaceChildren(...parts);
    if (again) drawing.querySelector(`circle[data-pose="${CSS.escape(again[0])}"][data-index="${again[1]}"]`)?.focus();
  }

  drawing.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !view) return;
    const { pose, index, reach } = event.target.dataset;
    if (index !== undefined) {
      event.preventDefault();
      drag = { pose, index: Number(index), moved: false };
      actions.choosePose(pose);
      drawing.querySelector(`circle[data-pose="${CSS.escape(pose)}"][data-index="${index}"]`)?.focus({ preventScroll: true });
    } else {
      if (reach !== undefined) actions.choosePose(reach);
      drag = { scrub: true };
      actions.lookAt(clamp(timeAt(place(event)[0]), 0, 1));
    }
    drawing.setPointerCapture(event.pointerId);
  });
  drawing.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const [px, py] = place(event);
    if (drag.scrub) {
      actions.lookAt(clamp(timeAt(px), 0, 1));
      return;
    }
    const [time, value] = snapped(px, py);
    const curves = moved(drag.pose, drag.index, time, value);
    if (String(curves[drag.pose][drag.index]) === String(points(drag.pose)[drag.index])) return;
    drag.moved = true;
    actions.preview(curves, clamp(curves[drag.pose][drag.index][0], 0, 1));
  });
  function release() {
    const done = drag;
    drag = null;
    if (done?.moved) actions.commit(view.pair.curves);
  }
  drawing.addEventListener("pointerup", release);
  drawing.addEventListener("pointercancel", release);

  drawing.addEventListener("dblclick", (event) => {
    if (!view || event.target.dataset.index !== undefined) return;
    const pose = view.pose ?? view.set.poses[0].name;
    const [time, value] = snapped(...place(event)).map((one) => round(one));
    if (time < 0 || time > 1) return;
    const row = points(pose) ?? [[0, 0], [1, 0]];
    const at = row.findIndex((point) => point[0] > time);
    const index = at < 0 ? row.length : at;
    actions.choosePose(pose);
    actions.commit({ ...view.pair.curves, [pose]: row.toSpliced(index, 0, [time, clamp(value, ...range)]) });
  });
  drawing.addEventListener("contextmenu", (event) => {
    const { pose, index } = event.target.dataset;
    if (index === undefined) return;
    event.preventDefault();
    actions.commit(without(pose, Number(index)));
  });
  drawing.addEventListener("keydown", (event) => {
    const { pose, index } = event.target.dataset;
    if (index === undefined) return;
    const step = event.shiftKey ? 5 * STEP : STEP;
    const moves = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (event.key === "Delete" || event.key === "Backspace") {
      event.preventDefault();
      actions.commit(without(pose, Number(index)));
    } else if (moves[event.key]) {
      event.preventDefault();
      const [time, value] = points(pose)[index];
      const curves = moved(pose, Number(index), time + moves[event.key][0], value + moves[event.key][1]);
      actions.preview(curves, clamp(curves[pose][index][0], 0, 1));
      clearTimeout(timer);
      timer = setTimeout(finish, IDLE);
    }
  });
  function finish() {
    clearTimeout(timer);
    if (!timer) return;
    timer = 0;
    actions.commit(view.pair.curves);
  }
  drawing.addEventListener("focusin", (event) => {
    if (event.target.dataset.pose && !drag) actions.choosePose(event.target.dataset.pose);
  });

  whenSized(root, (width, height) => {
    size = { width, height };
    draw();
  });
  return {
    finish, // an edit by keys that waits for more of them
    settle() { // it is part of another edit
      clearTimeout(timer);
      timer = 0;
    },
    isBusy: () => drag !== null || timer !== 0,
    update(next) {
      view = next;
      draw();
    },
  };
}

// The poses of the pair as chips, and a way to add one.
export function createPoseBar(actions) {
  const root = byId("poses");
  return {
    update({ set, pair, pose }) {
      const used = Object.keys(pair.curves);
      const ordered = set.poses.map((one) => one.name).filter((name) => used.includes(name));
      const chips = ordered.map((name) => {
        const chip = html("span", { class: name === pose ? "chip chosen" : "chip", colour: poseColour(set.poses, name) },
          html("button", { type: "button", class: "name", "aria-pressed": name === pose, text: name, onclick: () => actions.choosePose(name) }),
          html("button", { type: "button", class: "remove", "aria-label": `Remove ${name}`, title: `Remove ${name}`, text: "×",
            onclick: () => actions.removePose(name) }));
        return chip;
      });
      const rest = set.poses.map((one) => one.name).filter((name) => !used.includes(name));
      const select = html("select", { "aria-label": "Add a pose", onchange: () => actions.addPose(select.value, NEW_CURVE) },
        html("option", { value: "", text: "+ pose" }), ...rest.map((name) => html("option", { value: name, text: name })));
      root.replaceChildren(...chips, ...(rest.length ? [select] : []));
    },
  };
}

export const weightsAt = (dense, share) =>
  Object.fromEntries(Object.entries(dense).map(([pose, values]) => [pose, valueAt(values, share)]));
