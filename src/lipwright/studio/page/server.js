// Questions to the server and its answers.

export class ServerError extends Error {
  constructor(message, status) {
    super(message);
    this.status = status;
  }
}

async function ask(path, options) {
  let response;
  try {
    response = await fetch(path, options);
  } catch {
    throw new ServerError(
      "The editor's server does not answer. Start it again; your edits are kept beside the set.", 0);
  }
  if (response.ok) return response;
  let message = `The server answered ${response.status}`;
  try {
    message = (await response.json()).error ?? message;
  } catch { /* no JSON: the status must do */ }
  throw new ServerError(message, response.status);
}

export const get = async (path) => (await ask(path)).json();

const sending = (method, body) => ({
  method,
  headers: { "Content-Type": "application/json" },
  body: JSON.stringify(body),
});

export const post = async (path, body) => (await ask(path, sending("POST", body))).json();
export const put = async (path, body) => (await ask(path, sending("PUT", body))).json();
export const postForBlob = async (path, body) => (await ask(path, sending("POST", body))).blob();

// Runs `work` with the latest value only: while one is on its way, all but the last are forgotten.
export function latest(work) {
  let busy = false;
  let waiting = null;
  let generation = 0;
  async function run(value) {
    if (busy) {
      waiting = { value };
      return;
    }
    busy = true;
    const mine = generation;
    try {
      await work(value, () => mine === generation);
    } finally {
      busy = false;
      if (waiting) {
        const { value: next } = waiting;
        waiting = null;
        run(next);
      }
    }
  }
  run.forget = () => {
    waiting = null;
    generation += 1;
  };
  return run;
}
