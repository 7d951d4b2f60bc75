// The page: one state, and what changes it.

import { close, offerRecovery, offerReload, showError } from "./bars.js";
import { byId } from "./drawing.js";
import { createFace } from "./face.js";
import { showHeader } from "./header.js";
import { listenToKeys } from "./keys.js";
import { createLine } from "./line.js";
import { createMatrix } from "./matrix.js";
import { createPairEditor, createPoseBar, weightsAt } from "./pair.js";
import { createPlayer } from "./play.js";
import { createFacts, createPointTable } from "./points.js";
import { get, latest, post, put } from "./server.js";

const state = {
  set: null,
  status: null,
  pair: null,
  pose: null, // the one whose points are edited
  line: null,
  motion: null,
  time: 0, // s in the line
  playhead: null, // share of the pair, while it is looked at
  boundary: 0.5, // where the first phone of the pair ends
};

const face = createFace({ onTrouble: trouble });
const matrix = createMatrix({ onChoose: (key) => choosePair(key) });
const editor = createPairEditor({ choosePose, preview, commit, lookAt });
const poseBar = createPoseBar({ choosePose, addPose, removePose });
const table = createPointTable({ commit });
const facts = createFacts({
  note: (text) => commit(state.pair.curves, text),
  revert: () => change("/api/revert", { pair: state.pair.pair }),
  beginWith,
});
const line = createLine({ choose: choosePair, seek });
const player = createPlayer({ line: () => state.line, time: () => state.time, seek });

function trouble(error) {
  if (error.status === undefined) console.error(error);
  showError(error.message);
}

// ---- drawing what the state says

function show() {
  if (!state.pair) return;
  showHeader(state);
  const chosen = state.pair.pair;
  matrix.update({ ...state, chosen });
  poseBar.update(state);
  editor.update(state);
  table.update(state);
  facts.update(state);
  line.update({ ...state, chosen });
}

function showCurves() {
  editor.update(state);
  table.update(state);
  line.update({ ...state, chosen: state.pair.pair });
}

function showPicture() {
  if (state.playhead !== null) {
    face.show(weightsAt(state.pair.dense, state.playhead), `at ${state.playhead.toFixed(2)} of the pair`);
  } else if (state.motion) {
    const at = state.time * state.line.fps;
    const weights = Object.entries(state.motion.curves).map(([pose, values]) => {
      const low = Math.min(Math.floor(at), values.length - 1);
      const high = Math.min(low + 1, values.length - 1);
      return [pose, values[low] + (at - low) * (values[high] - values[low])];
    });
    face.show(Object.fromEntries(weights), `at ${state.time.toFixed(2)} s of the line`);
  } else {
    face.show({}, "at rest");
  }
}

// ---- choosing

function choosePose(pose) {
  if (state.pose === pose) return;
  state.pose = pose;
  show();
}

function firstPose() {
  const used = Object.keys(state.pair.curves);
  if (used.includes(state.pose)) return state.pose;
  const height = (pose) => Math.max(...state.pair.curves[pose].map(([, value]) => value));
  return used.sort((a, b) => height(b) - height(a))[0] ?? null;
}

// Where the first phone ends in the pair: as in the line, if it is said there.
function boundaryOf(key, span) {
  const said = span ?? state.motion?.pairs.find((one) => one.pair === key);
  if (!said) return 0.5;
  return (state.line.phones[said.index].end - said.start) / (said.end - said.start);
}

async function choosePair(key, span) {
  editor.finish();
  try {
    const pair = await get(`/api/pair?pair=${encodeURIComponent(key)}`);
    Object.assign(state, { pair, playhead: null, boundary: boundaryOf(key, span) });
    state.pose = firstPose();
    if (span) seek(state.line.phones[span.index].end);
    location.hash = encodeURIComponent(key);
    show();
    if (!span) lookAt(state.boundary);
  } catch (error) {
    trouble(error);
  }
}

function lookAt(share) {
  player.stop();
  state.playhead = share;
  editor.update(state);
  showPicture();
}

function seek(time) {
  state.time = time;
  state.playhead = null;
  line.seek(time);
  editor.update(state);
  showPicture();
}

// ---- editing

const askPreview = latest(async ({ pair, curves }, isWanted) => {
  try {
    const answer = await post("/api/preview", { pair, curves });
    if (!isWanted() || state.pair.pair !== pair) return;
    state.pair = { ...state.pair, dense: answer.dense };
    state.motion = answer.motion ?? state.motion;
    showCurves();
    showPicture();
  } catch (error) {
    trouble(error);
  }
});

function preview(curves, share) {
  player.stop();
  state.pair = { ...state.pair, curves };
  state.playhead = share;
  editor.update(state);
  table.update(state);
  askPreview({ pair: state.pair.pair, curves });
}

// Edits go to the server one after the other, each with the revision that the one before made.
let queue = Promise.resolve();
let queued = 0;

function change(path, body, ask = post) {
  askPreview.forget();
  queued += 1;
  queue = queue.then(async () => {
    try {
      const answer = await ask(path, { ...body, revision: state.status.revision });
      queued -= 1;
      take(answer, !body.pair);
      close("error");
    } catch (error) {
      queued -= 1;
      await refused(error);
    }
  });
  return queue;
}

function commit(curves, note = state.pair.note) {
  editor.settle();
  state.pair = { ...state.pair, curves, missing: false };
  change("/api/pair", { pair: state.pair.pair, curves, note }, put);
}

async function beginWith(key) {
  try {
    commit((await get(`/api/pair?pair=${encodeURIComponent(key)}`)).curves);
  } catch (error) {
    trouble(error);
  }
}

function addPose(pose, points) {
  state.pose = pose;
  commit({ ...state.pair.curves, [pose]: points });
}

function removePose(pose) {
  const { [pose]: _, ...others } = state.pair.curves;
  commit(others);
}

// What an edit has made; `jumps` to its pair, if another is shown meanwhile.
function take({ status, pair, motion }, jumps = false) {
  state.status = status;
  if (queued || editor.isBusy()) return; // the hand is quicker than the answer: keep what it holds
  if (pair && (jumps || pair.pair === state.pair.pair)) {
    state.pair = pair;
    state.pose = firstPose();
    if (jumps) location.hash = encodeURIComponent(pair.pair);
  }
  if (motion) state.motion = motion;
  show();
  showPicture();
}

async function refused(error) {
  trouble(error);
  if (error.status === 0) return;
  try {
    takeAll(await get("/api/set"));
    await choosePair(state.pair.pair);
  } catch (worse) {
    trouble(worse);
  }
}

async function save() {
  editor.finish();
  await queue;
  try {
    take(await post("/api/save", { revision: state.status.revision }));
    close("error");
  } catch (error) {
    if (error.status === 409) offerReload(error.message, (keep) => decide("/api/reload", keep));
    else trouble(error);
  }
}

async function decide(path, keep) {
  try {
    takeAll(await post(path, { keep }));
    close("reload");
    close("error");
    await choosePair(state.pair.pair);
  } catch (error) {
    trouble(error);
  }
}

// ---- the line

async function say(text) {
  byId("say").classList.add("busy");
  try {
    const answer = await post("/api/line", { text });
    Object.assign(state, answer, { time: 0, playhead: null });
    close("error");
    show();
    seek(0);
  } catch (error) {
    trouble(error);
  } finally {
    byId("say").classList.remove("busy");
  }
}

// ---- beginning

function takeAll(answer) {
  Object.assign(state, answer);
  face.setTrouble(answer.picture);
  byId("text").value = answer.line?.text ?? "";
  offerRecovery(state.status, (keep) => decide("/api/recover", keep));
}

function step(which) {
  editor.finish();
  if (state.status[which]) change(`/api/${which}`, {});
}

listenToKeys({ save, step, play: player.toggle });
byId("undo").addEventListener("click", () => step("undo"));
byId("redo").addEventListener("click", () => step("redo"));
byId("save").addEventListener("click", save);
byId("play").addEventListener("click", player.toggle);
byId("say").addEventListener("submit", (event) => {
  event.preventDefault();
  player.stop();
  say(byId("text").value);
});
window.addEventListener("hashchange", () => {
  const key = decodeURIComponent(location.hash.slice(1));
  if (key && key !== state.pair?.pair) choosePair(key);
});

async function begin() {
  try {
    takeAll(await get("/api/set"));
    const keys = Object.keys(state.status.sources);
    const wanted = decodeURIComponent(location.hash.slice(1));
    const said = state.motion?.pairs.find((one) => !one.pair.split(" ").includes("sil"))?.pair;
    const known = wanted.split(" ").length === 2 && wanted.split(" ").every((name) => state.set.classes.some((one) => one.name === name));
    const [first] = state.set.classes;
    await choosePair(known ? wanted : said ?? keys[0] ?? `${first.name} ${first.name}`);
    document.body.dataset.ready = "yes";
  } catch (error) {
    trouble(error);
  }
}

begin();
