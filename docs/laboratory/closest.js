// The closest point: a face whose nodes can be moved, a point, and every method on its way.
"use strict";

const CLOSEST_START = [
  -1, -1, 0, 1, -1, 0.2, 1, 1, 0, -1, 1, 0.4, 0, -1, 0.5, 1, 0, 0.3, 0, 1, 0.7, -1, 0, 0.3, 0.5, 0.3, 1.4,
];
const WHERE = ["inside", "on an edge", "at a corner", "outside"];
const STATUS = ["found", "not certified", "iteration limit", "no convergence", "invalid"];
const METHOD_WORDS = Object.fromEntries(WORDS.method.map((name) => [name, name.replaceAll("_", " ")]));
const STARTS = [-1, -0.8, -0.6, -0.4, -0.2, 0, 0.2, 0.4, 0.6, 0.8, 1];

LABORATORIES.closest = {
  title: "Closest point",
  job: "closest",
  price: () => "Drag a node or the point, drag beside them to turn, or press a place of the map to start there. " +
    "Keys: arrows turn, N chooses a node or the point, W A S D and Q E move it.",
  controls: [
    { name: "kind", label: "Face", words: { Q8: "Q8, eight nodes", Q4: "Q4, four nodes" }, start: "Q8" },
    { name: "method", label: "Method", words: METHOD_WORDS, start: "simplex" },
    { name: "start1", label: "Start ξ₁", values: STARTS, start: -0.8 },
    { name: "start2", label: "Start ξ₂", values: STARTS, start: -0.6 },
    { name: "steps", label: "Step", counted: true, values: [...Array(CLOSEST.most + 1).keys()], start: CLOSEST.most },
    { name: "nodes", count: 27, least: -3, most: 3, start: CLOSEST_START },
  ],
  build(laboratory) {
    return new ClosestView(laboratory);
  },
  // Another step of the same way needs no run.
  changed(laboratory, name) {
    if (name === "steps" && laboratory.last) laboratory.view.show(laboratory.last, laboratory.state);
    else laboratory.view.halt();
    return name === "steps" && laboratory.last !== null;
  },
};

class ClosestView {
  constructor(laboratory) {
    this.laboratory = laboratory;
    this.turn = new Turn(-0.9, 0.5);
    this.held = 8;
    this.pace = 400; // milliseconds of a step that is played
    this.playing = null;
    const label = "The face with its nodes, the point, and the closest point. Arrows turn it, N chooses, W A S D Q E move.";
    this.space = element("canvas", { class: "laboratory-plot", role: "application", tabindex: "0", "aria-label": label });
    const about = "Map of the distance over the reference square, with the way of the method";
    this.map = element("canvas", { class: "laboratory-plot", role: "img", "aria-label": about });
    this.table = element("table", { class: "laboratory-table" });
    this.fill(WORDS.method.map((name) => [METHOD_WORDS[name], "–", "–", "–", "–"]));
    const box = element("div", { class: "laboratory-wide" }, this.table);
    laboratory.pictures.append(this.space, this.walker(), box);
    for (const canvas of [this.space, this.map]) {
      canvas.style.height = "320px";
      new ResizeObserver(() => this.redraw()).observe(canvas);
    }
    const hold = (place) => (this.dragged = this.near(place)) !== null;
    followPointer(this.space, hold, (_, change) => this.drag(change));
    this.map.addEventListener("click", (event) => this.startAt([event.offsetX, event.offsetY]));
    this.space.addEventListener("keydown", (event) => this.key(event));
  }

  // The map with what moves the method: a slider, and buttons.
  walker() {
    const button = (text, press) => {
      const made = element("button", { type: "button" }, text);
      made.addEventListener("click", press);
      return made;
    };
    const by = (change) => () => {
      this.halt();
      this.walkTo(this.step + change);
    };
    this.playButton = button("Play", () => (this.playing ? this.halt() : this.play()));
    const buttons = element("div", { class: "laboratory-buttons" }, button("Back", by(-1)), this.playButton, button("Forward", by(1)));
    this.told = element("output", { class: "laboratory-verdict", "aria-live": "polite" });
    return element("div", { class: "laboratory-walk" }, this.map, this.laboratory.controls.steps.box, buttons, this.told);
  }

  // Number of steps of the way, and the one that is shown.
  get most() {
    return this.now ? this.now.part.way.length - 1 : 0;
  }

  get step() {
    return Math.min(this.laboratory.state.steps, this.most);
  }

  walkTo(step) {
    this.laboratory.set({ steps: Math.max(0, Math.min(step, this.most)) });
  }

  play() {
    if (this.step === this.most) this.walkTo(0);
    this.playButton.textContent = "Pause";
    this.playing = setInterval(() => {
      this.walkTo(this.step + 1);
      if (this.step === this.most) this.halt();
    }, this.pace);
  }

  halt() {
    clearInterval(this.playing);
    this.playing = null;
    this.playButton.textContent = "Play";
  }

  show(part, state) {
    this.now = { part, state: { ...state } };
    this.laboratory.controls.steps.limit(this.most, this.step);
    const [xi, y] = [part.way[this.step], part.walk[this.step]];
    const away = Math.hypot(...y.map((value, c) => value - this.placeOf(8)[c]));
    this.told.textContent = `${capital(METHOD_WORDS[state.method])}, step ${this.step} of ${this.most}: ξ = (${xi.map((each) => each.toFixed(3)).join(", ")}), distance ${away.toFixed(4)}`;
    this.redraw();
  }

  get count() {
    return this.laboratory.state.kind === "Q4" ? 4 : 8;
  }

  // Node `i` of the state, the point for 8.
  placeOf(i) {
    return this.laboratory.state.nodes.slice(3 * i, 3 * i + 3);
  }

  get scale() {
    return Math.min(this.space.clientWidth, 320) / 3.6;
  }

  onScreen(x) {
    const [right, up] = this.turn.axes;
    return [this.space.clientWidth / 2 + this.scale * dot(right, x), 160 - this.scale * dot(up, x)];
  }

  // The node or the point under the pointer, or null.
  near([x, y]) {
    const all = [...Array(this.count).keys(), 8];
    const away = (i) => Math.hypot(...this.onScreen(this.placeOf(i)).map((value, c) => value - [x, y][c]));
    const best = all.reduce((found, i) => (away(i) < away(found) ? i : found));
    if (away(best) > 22) return null;
    this.held = best;
    return best;
  }

  drag([dx, dy]) {
    if (this.dragged === null) {
      this.turn.by(dx / 150, dy / 150);
      this.redraw();
      return;
    }
    const [right, up] = this.turn.axes;
    this.move(this.dragged, right.map((value, c) => (value * dx - up[c] * dy) / this.scale));
  }

  move(i, by) {
    const nodes = [...this.laboratory.state.nodes];
    by.forEach((value, c) => {
      nodes[3 * i + c] = Math.max(-3, Math.min(3, Number((nodes[3 * i + c] + value).toFixed(3))));
    });
    this.laboratory.change("nodes", nodes);
    this.redraw();
  }

  key(event) {
    const [right, up, out] = this.turn.axes;
    const ways = { d: [right, 1], a: [right, -1], w: [up, 1], s: [up, -1], e: [out, 1], q: [out, -1] };
    const name = event.key.toLowerCase();
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (name === "n") this.held = this.held === 8 ? 0 : this.held + 1 < this.count ? this.held + 1 : 8;
    else if (ways[name]) this.move(this.held, ways[name][0].map((value) => 0.05 * ways[name][1] * value));
    else if (!this.turn.key(event.key)) return;
    event.preventDefault();
    this.redraw();
  }

  get cell() {
    return Math.min(this.map.clientWidth, 300);
  }

  // A press on the map: the nearest start of the sliders.
  startAt([x, y]) {
    const at = [x, y].map((value) => ((value / this.cell) * 2 - 1) * CLOSEST.reach);
    at[1] = -at[1];
    const nearest = (value) => STARTS.reduce((best, each) => (Math.abs(each - value) < Math.abs(best - value) ? each : best));
    this.laboratory.set({ start1: nearest(at[0]), start2: nearest(at[1]) });
  }

  redraw() {
    if (!this.now) return;
    this.drawSpace();
    this.drawMap();
  }

  drawSpace() {
    const made = penOf(this.space, 320);
    if (!made) return;
    const { pen } = made;
    const { part } = this.now;
    const text = getComputedStyle(this.space).color;
    pen.strokeStyle = COLOURS.grey;
    pen.lineWidth = 0.8;
    for (const line of part.lines) stroke(pen, line.map((x) => this.onScreen(x)));
    const certified = part.answers[CLOSEST.certified];
    const point = this.placeOf(8);
    pen.strokeStyle = COLOURS.green;
    pen.lineWidth = 1.6;
    stroke(pen, [point, [certified.x, certified.y, certified.z]].map((x) => this.onScreen(x)));
    const dot = (x, radius, colour) => {
      pen.fillStyle = colour;
      pen.beginPath();
      pen.arc(...this.onScreen(x), radius, 0, 7);
      pen.fill();
    };
    for (let i = 0; i < this.count; i++) dot(this.placeOf(i), 6, COLOURS.blue);
    dot([certified.x, certified.y, certified.z], 5, COLOURS.green);
    pen.strokeStyle = COLOURS.red;
    stroke(pen, part.walk.slice(0, this.step + 1).map((x) => this.onScreen(x)));
    dot(part.walk[this.step], 4, COLOURS.red);
    dot(point, 7, COLOURS.orange);
    pen.strokeStyle = text;
    pen.beginPath();
    pen.arc(...this.onScreen(this.placeOf(Math.min(this.held, 8))), 10, 0, 7);
    pen.stroke();
  }

  drawMap() {
    const made = penOf(this.map, 320);
    if (!made) return;
    const { pen } = made;
    const { part, state } = this.now;
    const size = this.cell;
    const place = ([a, b]) => [(a / CLOSEST.reach + 1) * 0.5 * size, (1 - b / CLOSEST.reach) * 0.5 * size];
    pen.drawImage(mapImage(part.values), 0, 0, size, size);
    pen.save();
    pen.beginPath();
    pen.rect(0, 0, size, size);
    pen.clip();
    pen.strokeStyle = "#101010";
    stroke(pen, [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].map(place));
    this.drawWay(pen, place, part, state);
    pen.restore();
    pen.fillStyle = getComputedStyle(this.map).color;
    pen.font = plotFont();
    pen.fillText("ξ₁ to the right, ξ₂ up; pale: near the point", 0, size + 16);
  }

  drawWay(pen, place, part, state) {
    const { step } = this;
    pen.strokeStyle = pen.fillStyle = COLOURS.orange;
    pen.lineWidth = 1.2;
    part.triangles?.slice(0, step + 1).forEach((corners, i) => {
      stroke(pen, [...corners, corners[0]].map(place));
      pen.globalAlpha = 0.4;
      if (i === step) pen.fill();
      pen.globalAlpha = 1;
    });
    pen.strokeStyle = COLOURS.red;
    pen.lineWidth = 2;
    stroke(pen, part.way.slice(0, step + 1).map(place));
    const certified = part.answers[CLOSEST.certified];
    const mark = ([x, y], radius, colour, fill) => {
      pen.strokeStyle = pen.fillStyle = colour;
      pen.beginPath();
      pen.arc(x, y, radius, 0, 7);
      if (fill) pen.fill();
      else pen.stroke();
    };
    mark(place([state.start1, state.start2]), 5, "#101010", false);
    mark(place([certified.xi1, certified.xi2]), 5, COLOURS.green, true);
    mark(place(part.way[step]), 4, COLOURS.red, true);
  }

  // One row per method.
  fill(rows) {
    const head = ["method", "evaluations", "distance", "ends", "answer"];
    const line = (tag, cells) => element("tr", {}, ...cells.map((cell) => element(tag, {}, String(cell))));
    this.table.replaceChildren(element("thead", {}, line("th", head)), element("tbody", {}, ...rows.map((row) => line("td", row))));
  }

  rows(part) {
    const best = part.answers[CLOSEST.certified].distance;
    return part.answers.map((answer, i) => {
      const same = answer.where < 3 && Math.abs(answer.distance - best) <= 1e-6 * (1 + best);
      const verdict = answer.status > 1 ? STATUS[answer.status] : same ? "closest" : "another point";
      const distance = Number.isFinite(answer.distance) ? answer.distance.toFixed(6) : "none";
      return [METHOD_WORDS[WORDS.method[i]], answer.evaluations, distance, WHERE[answer.where] ?? "", verdict];
    });
  }

  finish(part, state) {
    this.fill(this.rows(part));
    const answer = part.answers[WORDS.method.indexOf(state.method)];
    const certified = part.answers[CLOSEST.certified];
    const proof = certified.certified ? "proved to be the smallest" : "not proved";
    return (
      `${capital(METHOD_WORDS[state.method])} from (${state.start1}, ${state.start2}): ${answer.evaluations} evaluations, ` +
      `${STATUS[answer.status]}, ${WHERE[answer.where] ?? "nowhere"}. ` +
      `The distance is ${certified.distance.toFixed(6)}, ${proof}, at ξ = (${certified.xi1.toFixed(4)}, ${certified.xi2.toFixed(4)}).`
    );
  }
}

// Distances as an image, the smallest pale, in bands so that lines of equal distance are seen.
function mapImage(values) {
  const n = CLOSEST.cells;
  const canvas = new OffscreenCanvas(n, n);
  const pen = canvas.getContext("2d");
  const image = pen.createImageData(n, n);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  values.forEach((value, i) => {
    const band = Math.floor(24 * Math.sqrt((value - low) / (high - low || 1))) / 24;
    const at = 4 * ((i % n) + n * (n - 1 - Math.floor(i / n)));
    image.data.set([235 - 150 * band, 240 - 120 * band, 245 - 60 * band, 255], at);
  });
  pen.putImageData(image, 0, 0);
  return canvas;
}
