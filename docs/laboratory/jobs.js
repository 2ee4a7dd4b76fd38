// The work of a laboratory, in its worker: the run of a scene in parts, so that it can be stopped between two.
"use strict";

const JOBS = {};
// Milliseconds of a part, and the most steps and element updates of a run.
const PART = 30;
const MOST_STEPS = 2e6;
const MOST_UPDATES = 2e9;

// Advance the run that `buildScene` began to its end. After each part `sample` is called; it may be called more often,
// every `every` steps. `pause` lets messages in, and throws where the page has asked to stop.
async function advanceAll(library, every, sample, pause) {
  const call = library.call;
  const total = call.step_count();
  let elements = 0;
  for (let body = 0; body < call.body_count(); body++) elements += call.element_count(body);
  if (total > MOST_STEPS || total * elements > MOST_UPDATES) {
    throw new LibraryError(
      `the run needs ${total.toPrecision(3)} steps of ${elements} elements; a page takes at most ` +
        `${MOST_STEPS} steps and ${MOST_UPDATES} element updates`,
    );
  }
  let left = performance.now() + PART;
  let milliseconds = 0;
  for (let done = 0; done < total; ) {
    const count = Math.min(every, total - done);
    const began = performance.now();
    library.check(call.advance(count));
    milliseconds += performance.now() - began;
    done += count;
    sample(done / total);
    if (performance.now() > left) {
      await pause();
      left = performance.now() + PART;
    }
  }
  library.check(call.sample_probes());
  // A browser may round its clock, to 1 ms at most.
  const seconds = Math.max(milliseconds, 1) / 1000;
  return { steps: total, elements, updates: total * elements, computed: call.element_updates(), seconds };
}
