// What the animator must know or decide, above the page.

import { arrow, byId, html } from "./drawing.js";

const root = () => byId("bars");

function bar(id, kind, text, buttons) {
  close(id);
  const close_ = html("button", { type: "button", class: "remove", "aria-label": "Close", text: "×", onclick: () => close(id) });
  root().append(html("div", { class: `bar ${kind}`, "data-bar": id }, html("span", { text }),
    ...buttons.map(([label, act]) => html("button", { type: "button", text: label, onclick: act })),
    ...(buttons.length ? [] : [close_])));
}

export function close(id) {
  root().querySelector(`[data-bar="${id}"]`)?.remove();
}

export function showError(message) {
  bar("error", "error", message, []);
}

export function offerRecovery(status, decide) {
  if (!status.pending.length) {
    close("pending");
    return;
  }
  const names = status.pending.slice(0, 4).map(arrow).join(", ");
  const more = status.pending.length > 4 ? ` and ${status.pending.length - 4} more` : "";
  const stale = status.stale ? " The file was changed since then." : "";
  bar("pending", "warning", `Edits of the last time were not saved: ${names}${more}.${stale}`,
    [["Take them up again", () => decide(true)], ["Forget them", () => decide(false)]]);
}

export function offerReload(message, decide) {
  bar("reload", "warning", message, [
    ["Reload, keep my edits", () => decide(true)],
    ["Reload, drop my edits", () => decide(false)],
    ["Not now", () => close("reload")],
  ]);
}
