// Elements, colours and scales that all drawings share.

const SVG = "http://www.w3.org/2000/svg";

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name === "text") element.textContent = value;
    else if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "colour") element.style.setProperty("--colour", value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

export const html = (tag, attributes = {}, ...children) =>
  fill(document.createElement(tag), attributes, children);
export const svg = (tag, attributes = {}, ...children) =>
  fill(document.createElementNS(SVG, tag), attributes, children);
export const byId = (id) => document.getElementById(id);

const NAMED = 10; // colours in the style sheet

export function poseColour(poses, name) {
  const index = poses.findIndex((pose) => pose.name === name);
  if (index < NAMED) return `var(--pose-${index})`;
  return `hsl(${Math.round(index * 137.5) % 360} 55% var(--pose-light))`;
}

export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
export const round = (value, decimals = 3) => Number(value.toFixed(decimals));

// The path of values at even x from x0 to x1.
export function evenPath(values, x0, x1, y) {
  const step = (x1 - x0) / Math.max(values.length - 1, 1);
  return values.map((value, i) => `${i ? "L" : "M"}${(x0 + i * step).toFixed(1)} ${y(value).toFixed(1)}`).join("");
}

export function valueAt(values, share) {
  const place = clamp(share, 0, 1) * (values.length - 1);
  const low = Math.min(Math.floor(place), Math.max(values.length - 2, 0));
  const high = Math.min(low + 1, values.length - 1);
  return values[low] + (place - low) * (values[high] - values[low]);
}

export const arrow = (key) => key.replace(" ", " → ");

// Calls `draw(width, height)` now and whenever the element's size changes.
export function whenSized(element, draw) {
  let last = "";
  const look = () => {
    const size = `${element.clientWidth} ${element.clientHeight}`;
    if (size === last) return;
    last = size;
    draw(element.clientWidth, element.clientHeight);
  };
  new ResizeObserver(look).observe(element);
}
