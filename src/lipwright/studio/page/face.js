// The head, drawn by the server.

import { byId, html } from "./drawing.js";
import { latest, postForBlob } from "./server.js";

const VIEWS = ["face", "mouth"];

export function createFace({ onTrouble }) {
  const canvas = byId("picture");
  const context = canvas.getContext("2d");
  let trouble = "";
  let view = "face";
  let last = {};

  const draw = latest(async (weights) => {
    try {
      const blob = await postForBlob("/api/picture", { poses: weights, view });
      const picture = await createImageBitmap(blob);
      context.drawImage(picture, 0, 0, canvas.width, canvas.height);
      canvas.dataset.drawn = Number(canvas.dataset.drawn ?? 0) + 1;
    } catch (error) {
      onTrouble(error);
    }
  });

  const buttons = VIEWS.map((name) => html("button", { type: "button", text: name, "aria-pressed": name === view,
    onclick: () => {
      view = name;
      for (const button of buttons) button.setAttribute("aria-pressed", button.textContent === name);
      draw(last);
    } }));
  byId("views").append(...buttons);

  return {
    setTrouble(text) {
      trouble = text;
      byId("no-picture").textContent = text ? `No picture: ${text}` : "";
      byId("no-picture").hidden = !text;
      canvas.hidden = Boolean(text);
      byId("views").hidden = Boolean(text);
    },
    show(weights, about) {
      byId("face-at").textContent = about;
      last = weights;
      if (!trouble) draw(weights);
    },
  };
}
