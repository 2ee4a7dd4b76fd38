// The worker of a page: one job at a time, which looks for a message to stop between its parts.
"use strict";

class Stopped extends Error {}

let library = null;
let running = 0;

// Let messages in; throws if another job or a stop has come.
function pauseOf(id) {
  return () => new Promise((go, fail) => {
    setTimeout(() => (running === id ? go() : fail(new Stopped())), 0);
  });
}

async function start({ id, bytes, job, state }) {
  running = id;
  const tell = (part) => postMessage({ id, part });
  try {
    if (bytes) library = await Library.open(bytes);
    const result = await JOBS[job](library, state, tell, pauseOf(id));
    postMessage({ id, done: result });
  } catch (error) {
    if (error instanceof Stopped) postMessage({ id, stopped: true });
    else postMessage({ id, failed: error instanceof LibraryError ? error.message : String(error) });
  }
}

onmessage = ({ data }) => {
  if (data.stop) running = 0;
  else start(data);
};
