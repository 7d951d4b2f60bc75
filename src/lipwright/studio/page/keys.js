// Keys of the whole page.

const isTyping = (target) => target.matches?.("input[type=text], input[type=number], select");

export function listenToKeys({ save, step, play }) {
  document.addEventListener("keydown", (event) => {
    const control = event.ctrlKey || event.metaKey;
    const key = event.key.toLowerCase();
    if (control && key === "s") {
      event.preventDefault();
      save();
    } else if (control && (key === "z" || key === "y") && !event.target.matches?.("input[type=text]")) {
      event.preventDefault();
      step(key === "y" || event.shiftKey ? "redo" : "undo");
    } else if (event.key === " " && !isTyping(event.target) && !event.target.matches?.("button")) {
      event.preventDefault();
      play();
    }
  });
}
