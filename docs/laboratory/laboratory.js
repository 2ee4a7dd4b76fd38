// A laboratory in a page: its controls, its run, its state in the address, its captions.
"use strict";

const LABORATORIES = {};
// Milliseconds after the last change of a control until the run starts again.
const QUIET = 150;

function reducedMotion() {
  return matchMedia("(prefers-reduced-motion: reduce)").matches;
}

// The pictures of a laboratory, drawn from the last part of a run: with draw(part, state) of each.
class View {
  show(part, state) {
    this.now = { part, state };
    this.redraw();
  }

  redraw() {
    if (this.now) this.draw(this.now.part, this.now.state);
  }
}

class Laboratory {
  constructor(box, name) {
    this.box = box;
    this.name = name;
    this.own = LABORATORIES[name];
    this.remote = new Remote();
    this.runs = 0;
    this.last = null;
    this.frame = null;
    this.ready = false;
    this.waiting = false;
    this.state = readState(this.own.controls, this.addressed());
    this.build();
    addEventListener("hashchange", () => this.restore());
    const seen = new IntersectionObserver((entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      seen.disconnect();
      this.start();
    });
    seen.observe(this.live);
    new MutationObserver(() => this.redraw()).observe(document.body, { attributeFilter: ["data-theme"] });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
  }

  // What the address says of this laboratory, "#bar:law=penalty&beta=10"; null: nothing.
  addressed() {
    const [name, text] = location.hash.slice(1).split(":", 2);
    return name === this.name ? (text ?? "") : null;
  }

  build() {
    this.controls = {};
    const form = element("form", { class: "laboratory-controls" });
    form.addEventListener("submit", (event) => event.preventDefault());
    for (const declared of this.own.controls.filter(({ label }) => label)) {
      const make = declared.words ? choice : slider;
      const control = make(declared, this.state[declared.name], (value) => this.change(declared.name, value));
      this.controls[declared.name] = control;
      form.append(control.box);
    }
    this.runButton = element("button", { type: "button" }, "Run");
    this.stopButton = element("button", { type: "button", disabled: "" }, "Stop");
    this.runButton.addEventListener("click", () => this.start());
    this.stopButton.addEventListener("click", () => this.stop());
    this.link = element("a", { class: "laboratory-link" }, "Link to this state");
    form.append(element("div", { class: "laboratory-buttons" }, this.runButton, this.stopButton, this.link));
    this.status = element("output", { class: "laboratory-status", "aria-live": "polite" });
    this.caption = element("p", { class: "laboratory-caption", "aria-live": "polite" });
    this.pictures = element("div", { class: "laboratory-pictures" });
    const label = `Laboratory: ${this.own.title}`;
    this.live = element("section", { class: "laboratory-live", "aria-label": label });
    this.live.append(form, this.pictures, this.status, this.caption);
    this.box.append(this.live);
    this.box.classList.add("alive");
    this.view = this.own.build(this);
    this.writeLink();
  }

  writeLink() {
    const text = writeState(this.own.controls, this.state);
    this.link.href = `#${this.name}:${text}`;
    return text;
  }

  change(name, value) {
    this.state[name] = value;
    const text = this.writeLink();
    history.replaceState(null, "", `#${this.name}:${text}`);
    if (this.own.changed?.(this, name)) return;
    clearTimeout(this.timer);
    this.waiting = true;
    this.timer = setTimeout(() => this.start(), QUIET);
  }

  // Set controls to values that a picture gives.
  set(values) {
    for (const [name, value] of Object.entries(values)) {
      this.controls[name].set(value);
      this.change(name, value);
    }
  }

  // Take the state of the address, after it has changed.
  restore() {
    const text = this.addressed();
    if (text === null) return;
    this.state = readState(this.own.controls, text);
    for (const [name, control] of Object.entries(this.controls)) control.set(this.state[name]);
    this.view.restored?.();
    this.writeLink();
    this.start();
  }

  async start() {
    clearTimeout(this.timer);
    this.waiting = false;
    this.ready = false;
    const own = ++this.runs;
    const state = { ...this.state };
    this.stopButton.disabled = false;
    this.live.setAttribute("aria-busy", "true");
    this.status.textContent = "running …";
    try {
      const given = this.own.prepare ? this.own.prepare(state) : state;
      const result = await this.remote.run(this.own.job, given, (part) => this.receive(part, state));
      this.dropFrame();
      if (result) {
        this.draw(state);
        this.caption.textContent = this.view.finish(this.last, state, result);
        this.status.textContent = this.own.price(result);
      } else if (own === this.runs) {
        this.status.textContent = "stopped";
      }
    } catch (error) {
      this.remote.stop();
      this.dropFrame();
      this.status.textContent = `failed: ${error instanceof SceneFault ? faultText(error) : error.message}`;
    }
    if (own === this.runs) this.rest();
  }

  // Take a part of a run; of those that come within a frame of the screen the last one is drawn.
  receive(part, state) {
    this.last = part;
    if (part.fraction === 0) this.view.begin?.(part);
    if (this.frame || reducedMotion()) return;
    this.frame = requestAnimationFrame(() => {
      this.status.textContent = `running: ${Math.round(100 * this.last.fraction)} %`;
      this.draw(state);
    });
  }

  dropFrame() {
    cancelAnimationFrame(this.frame);
    this.frame = null;
  }

  draw(state) {
    this.dropFrame();
    this.view.show(this.last, state);
  }

  // Whether no run is going on or about to begin.
  get idle() {
    return this.ready && !this.waiting && this.remote.current === null;
  }

  rest() {
    this.ready = true;
    this.stopButton.disabled = true;
    this.live.removeAttribute("aria-busy");
  }

  stop() {
    clearTimeout(this.timer);
    this.waiting = false;
    this.remote.stop();
  }

  redraw() {
    this.view.redraw();
  }
}

// What a run has cost; `seconds` are those of the library.
function price({ steps, elements, updates, step, unit, seconds }) {
  return (
    `${steps} steps of ${digits(step)} ${unit}, ${elements} elements, ${digits(updates)} element updates, ` +
    `${digits(seconds)} s (${digits(updates / seconds)} updates per second)`
  );
}
