// Plays the line in real time, or slower.

import { byId } from "./drawing.js";

const NEAR = 0.02; // s before the end: it begins again

// `line` and `time` say what is shown now; `seek` shows another time.
export function createPlayer({ line, time, seek }) {
  let request = 0;

  function stop() {
    if (!request) return;
    cancelAnimationFrame(request);
    request = 0;
    byId("play").textContent = "Play";
  }

  function begin({ duration }) {
    let now = time() >= duration - NEAR ? 0 : time();
    let last = performance.now();
    const step = (clock) => {
      now += (Math.max(clock - last, 0) / 1000) * Number(byId("speed").value);
      last = clock;
      seek(Math.min(now, duration));
      if (now >= duration) stop();
      else request = requestAnimationFrame(step);
    };
    byId("play").textContent = "Pause";
    request = requestAnimationFrame(step);
  }

  return {
    stop,
    toggle() {
      if (request) stop();
      else if (line()) begin(line());
    },
  };
}
