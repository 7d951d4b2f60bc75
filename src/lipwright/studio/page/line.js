// The line: words, phones and the final curves; where it is looked at, and by which pair.

import { arrow, byId, clamp, evenPath, html, poseColour, svg, whenSized } from "./drawing.js";

const PACE = 170; // pixels a second at least
const LEFT = 30;
const RIGHT = 12;
const TOP = 8;
const ROW = 24; // a row of names
const NARROW = 9; // pixels below which a phone has no room for its name

export function createLine(actions) {
  const root = byId("said");
  const drawing = svg("svg", { role: "group", "aria-label": "Phones and final curves of the line" });
  root.append(drawing);
  const head = svg("line", { class: "playhead" });
  let view = null;
  let size = { width: 0, height: 0 };
  let scrubbing = false;

  const width = () => Math.max(size.width, LEFT + RIGHT + (view?.line?.duration ?? 0) * PACE);
  const x = (time) => LEFT + (time / view.line.duration) * (width() - LEFT - RIGHT);
  const bottom = () => size.height - 2 * ROW - 22;
  let range = [0, 1];
  const y = (value) => bottom() - ((value - range[0]) / (range[1] - range[0])) * (bottom() - TOP);

  function curves() {
    const parts = [];
    for (const level of [0, 0.5, 1]) {
      parts.push(svg("line", { class: level ? "grid" : "axis", x1: LEFT, x2: width() - RIGHT, y1: y(level), y2: y(level) }));
      parts.push(svg("text", { class: "tick", x: LEFT - 6, y: y(level) + 4, "text-anchor": "end", text: level }));
    }
    const { fps, duration } = view.line;
    for (const [pose, values] of Object.entries(view.motion.curves)) {
      const said = values.slice(0, Math.floor(duration * fps) + 1); // the last frame is after the end
      parts.push(svg("path", {
        class: pose === view.pose ? "spline chosen" : "spline", colour: poseColour(view.set.poses, pose),
        d: evenPath(said, x(0), x((said.length - 1) / fps), y),
      }));
    }
    return parts;
  }

  function spans() {
    return view.motion.pairs.filter((one) => one.pair === view.chosen).map((one) =>
      svg("rect", { class: "pair-span", x: x(one.start), width: x(one.end) - x(one.start), y: TOP, height: bottom() + ROW - TOP }));
  }

  function names() {
    const parts = [];
    view.line.phones.forEach((phone, index) => {
      const [left, right] = [x(phone.start), x(phone.end)];
      parts.push(svg("line", { class: "edge", x1: left, x2: left, y1: TOP, y2: bottom() + ROW }));
      parts.push(svg("rect", { class: "phone", x: left, width: right - left, y: bottom(), height: ROW, "data-phone": index }));
      if (right - left >= NARROW) {
        parts.push(svg("text", { class: phone.phone === "sil" ? "phone-label quiet" : "phone-label", x: (left + right) / 2, y: bottom() + 16, "text-anchor": "middle", text: phone.phone }));
      }
    });
    for (const word of view.line.words) {
      parts.push(svg("text", { class: "word", x: (x(word.start) + x(word.end)) / 2, y: bottom() + ROW + 16, "text-anchor": "middle", text: word.text }));
    }
    const every = view.line.duration > 12 ? 1 : 0.5;
    for (let time = 0; time <= view.line.duration; time += every) {
      parts.push(svg("text", { class: "tick", x: x(time), y: size.height - 6, "text-anchor": "middle", text: `${time} s` }));
    }
    return parts;
  }

  // A mark at each edge stands for the pair of the phones on both sides.
  function marks() {
    return view.motion.pairs.map((one) => {
      const edge = x(view.line.phones[one.index].end);
      const source = view.status.sources[one.pair];
      const kind = `kind-${source ?? "missing"}${view.inherited.has(one.pair) ? " inherited" : ""}`;
      return svg("circle", {
        class: `mark ${kind}${one.pair === view.chosen ? " chosen" : ""}`, cx: edge, cy: bottom() + ROW, r: 5,
        "data-mark": one.index, "data-pair": one.pair, tabindex: 0, role: "button",
        "aria-label": `Pair ${arrow(one.pair)}${source ? "" : ", missing"}`,
      }, svg("title", { text: arrow(one.pair) }));
    });
  }

  function draw() {
    if (!size.width || (view?.line && size.height < 120)) {
      root.classList.toggle("empty", !(view?.line && view.motion));
      return;
    }
    const known = view?.line && view.motion;
    root.classList.toggle("empty", !known);
    if (!known) {
      drawing.replaceChildren();
      return;
    }
    const held = drawing.contains(document.activeElement) ? document.activeElement.dataset.mark : undefined;
    const most = Math.max(1.05, ...Object.values(view.motion.curves).map((values) => Math.max(...values)));
    range = [0, most];
    drawing.setAttribute("width", width());
    drawing.setAttribute("viewBox", `0 0 ${width()} ${size.height}`);
    drawing.replaceChildren(...spans(), ...curves(), ...names(), ...marks(), head);
    if (held !== undefined) drawing.querySelector(`[data-mark="${held}"]`)?.focus({ preventScroll: true });
    seek(view.time);
  }

  function seek(time) {
    if (!view?.line) return;
    view.time = time;
    for (const [name, value] of [["x1", x(time)], ["x2", x(time)], ["y1", TOP], ["y2", bottom() + ROW]]) head.setAttribute(name, value);
    byId("scrub").value = time / view.line.duration;
    byId("line-about").textContent = `${time.toFixed(2)} of ${view.line.duration.toFixed(2)} s`;
  }

  const timeOf = (event) => {
    const box = drawing.getBoundingClientRect();
    return clamp(((event.clientX - box.left - LEFT) / (width() - LEFT - RIGHT)) * view.line.duration, 0, view.line.duration);
  };

  // The half of a phone that is nearer to its edge with another chooses their pair.
  function choose(index, time) {
    const phone = view.line.phones[index];
    const later = time > (phone.start + phone.end) / 2;
    const wanted = [later ? index : index - 1, later ? index - 1 : index];
    const found = wanted.map((place) => view.motion.pairs.find((one) => one.index === place)).find(Boolean);
    if (found) actions.choose(found.pair, found);
  }

  drawing.addEventListener("pointerdown", (event) => {
    if (!view?.line || event.button !== 0) return;
    const { mark, phone } = event.target.dataset;
    if (mark !== undefined) pick(mark);
    else if (phone !== undefined) choose(Number(phone), timeOf(event));
    else {
      scrubbing = true;
      drawing.setPointerCapture(event.pointerId);
      actions.seek(timeOf(event));
    }
  });
  drawing.addEventListener("pointermove", (event) => scrubbing && actions.seek(timeOf(event)));
  for (const kind of ["pointerup", "pointercancel"]) drawing.addEventListener(kind, () => { scrubbing = false; });
  const pick = (mark) => {
    const found = view.motion.pairs.find((one) => one.index === Number(mark));
    actions.choose(found.pair, found);
  };
  drawing.addEventListener("keydown", (event) => {
    const { mark } = event.target.dataset;
    if (mark === undefined) return;
    if (event.key === "Enter" || event.key === " ") {
      event.preventDefault();
      event.stopPropagation();
      pick(mark);
    }
  });
  byId("scrub").addEventListener("input", (event) => view?.line && actions.seek(event.target.valueAsNumber * view.line.duration));

  whenSized(root, (newWidth, height) => {
    size = { width: newWidth, height };
    draw();
  });
  return {
    seek,
    update(next) {
      view = { ...next, inherited: new Set(next.status.inherited) };
      draw();
    },
  };
}
