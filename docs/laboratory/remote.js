// The page's side of the worker: it starts a job, stops it, and ends the worker when the page is left.
"use strict";

// Milliseconds after which a worker that does not answer a stop is ended.
const PATIENCE = 500;
const LABORATORY_FOLDER = document.currentScript.src.replace(/[^/]*$/, "");

// A packed file, whose script is loaded when it is first needed.
function packedFile(name) {
  if (laboratoryFiles.has(name)) return Promise.resolve(laboratoryFiles.get(name));
  return new Promise((done, fail) => {
    const script = document.createElement("script");
    script.src = `${LABORATORY_FOLDER}${name}.js`;
    script.onload = () => done(laboratoryFiles.get(name));
    script.onerror = () => fail(new Error(`${name}.js is not beside the page`));
    document.head.append(script);
  });
}

class Remote {
  static bytes = null;

  constructor() {
    this.worker = null;
    this.count = 0;
    this.current = null;
    addEventListener("pagehide", () => this.end());
  }

  // Run a job; `show` gets its parts. Resolves with its result, or null where it was stopped.
  async run(job, state, show) {
    const stopped = this.stop();
    const id = this.count;
    Remote.bytes ??= packedFile("module").then(unpack);
    const [bytes] = await Promise.all([Remote.bytes, stopped]);
    if (id !== this.count) return null;
    const fresh = this.worker === null;
    if (fresh) this.open();
    return new Promise((done, fail) => {
      this.current = { id, show, done, fail };
      this.worker.postMessage({ id, job, state, bytes: fresh ? bytes : undefined });
    });
  }

  open() {
    const source = new Blob([LABORATORY_WORKER], { type: "text/javascript" });
    const address = URL.createObjectURL(source);
    this.worker = new Worker(address);
    URL.revokeObjectURL(address);
    this.worker.onmessage = ({ data }) => this.take(data);
    this.worker.onerror = (event) => this.take({ id: this.current?.id, failed: event.message });
  }

  take(data) {
    const current = this.current;
    if (!current || data.id !== current.id) return;
    if (data.part) {
      current.show(data.part);
      return;
    }
    this.current = null;
    // After a failure the memory of the module may be in any state.
    if (data.failed) this.end();
    if (data.failed) current.fail(new Error(data.failed));
    else current.done(data.done ?? null);
    current.stopped?.();
  }

  // Ask the job to stop, and end the worker if it does not. Resolves when the job is over.
  stop() {
    this.count++;
    const current = this.current;
    if (!current) return Promise.resolve();
    this.worker.postMessage({ stop: true });
    return new Promise((over) => {
      current.stopped = over;
      setTimeout(() => {
        if (this.current !== current) return;
        this.end();
        current.done(null);
        over();
      }, PATIENCE);
    });
  }

  end() {
    this.worker?.terminate();
    this.worker = null;
    this.current = null;
  }
}
