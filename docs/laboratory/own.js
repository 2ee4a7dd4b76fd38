// Your own scene: an editor, the check, a picture that turns, the energy balance, and files.
"use strict";

LABORATORIES.own = {
  title: "Your own scene",
  job: "own",
  price,
  controls: [
    { name: "example", label: "Begin with", words: Object.fromEntries(LABORATORY_EXAMPLES.map(({ name, title }) => [name, title])), start: LABORATORY_EXAMPLES[0].name },
    { name: "text", longest: 8000, start: "" },
  ],
  build(laboratory) {
    return new OwnView(laboratory);
  },
  // An example replaces the text and runs; a change of the text is only checked.
  changed(laboratory, name) {
    if (name === "text") {
      laboratory.view.check();
      return true;
    }
    if (laboratory.state.text) laboratory.change("text", "");
    laboratory.view.take("");
    return false;
  },
  prepare(state) {
    return readScene(textOf(state));
  },
};

function textOf({ example, text }) {
  return text || LABORATORY_EXAMPLES.find(({ name }) => name === example).text;
}

class OwnView {
  constructor(laboratory) {
    this.laboratory = laboratory;
    this.turn = new Turn(-1.1, 0.45);
    this.area = element("textarea", { id: "laboratory-scene", rows: 22, spellcheck: "false", wrap: "off" });
    this.area.addEventListener("input", () => laboratory.change("text", this.area.value));
    this.area.addEventListener("keydown", (event) => event.ctrlKey && event.key === "Enter" && laboratory.start());
    this.verdict = element("output", { class: "laboratory-verdict", "aria-live": "polite" });
    const label = element("label", { for: "laboratory-scene" }, "Scene (TOML); Ctrl Enter runs it");
    const editor = element("div", { class: "laboratory-scene" }, label, this.area, this.verdict);
    const about = "The bodies, coloured by von Mises stress. Arrow keys turn the picture.";
    this.space = element("canvas", { class: "laboratory-plot", role: "application", tabindex: "0", "aria-label": about });
    this.space.style.height = "380px";
    followPointer(this.space, () => false, (_, [dx, dy]) => {
      this.turn.by(dx / 150, dy / 150);
      this.draw();
    });
    this.space.addEventListener("keydown", (event) => {
      if (!this.turn.key(event.key)) return;
      event.preventDefault();
      this.draw();
    });
    new ResizeObserver(() => this.draw()).observe(this.space);
    this.energy = new Plot({ x: "time", y: "energy", height: 220, label: "The energy balance over time" });
    this.table = element("table", { class: "laboratory-table" });
    this.files = ["vtu", "csv"].map((kind) => {
      const button = element("button", { type: "button", disabled: "" }, `Save .${kind}`);
      button.addEventListener("click", () => this.save(kind));
      return button;
    });
    const side = element("div", {}, this.table, element("div", { class: "laboratory-buttons" }, ...this.files));
    laboratory.pictures.append(this.space, editor, this.energy.canvas, side);
    this.take(laboratory.state.text);
  }

  // Put a text into the editor; "": that of the example.
  take(text) {
    this.laboratory.state.text = text;
    this.area.value = textOf(this.laboratory.state);
    this.check();
  }

  restored() {
    this.take(this.laboratory.state.text);
  }

  check() {
    try {
      readScene(this.area.value);
      this.verdict.textContent = "The scene can be run.";
    } catch (fault) {
      if (!(fault instanceof SceneFault)) throw fault;
      this.verdict.textContent = faultText(fault);
    }
  }

  begin({ skins, at, units }) {
    const { time } = units;
    this.units = { time, stress: unitOf("stress", units) };
    this.energy.names = { x: `time [${time}]`, y: `energy [${unitOf("energy", units)}]` };
    for (const button of this.files) button.disabled = true;
    this.skins = skins;
    this.fit(at);
  }

  show(part) {
    this.part = part;
    this.redraw();
  }

  // The middle and the size of what is seen.
  fit(at) {
    this.middle = middleOf(at);
    this.size = Math.hypot(...boundsOf(at).map(([low, high]) => high - low));
  }

  redraw() {
    if (!this.part) return;
    this.draw();
    const { ledger } = this.part;
    const x = ledger.map((row) => row.time);
    const colours = { kinetic: "blue", strain: "orange", contact: "green", external: "violet", total: "text" };
    const curves = Object.entries(colours).map(([name, colour]) => ({ x, y: ledger.map((row) => row[name]), colour, name }));
    this.energy.draw(curves, { x: [0, x.at(-1) || 1], y: rangeOf(curves.map((curve) => curve.y), [0]) });
  }

  // Faces from the farthest to the nearest.
  draw() {
    if (!this.part || !this.skins) return;
    const made = penOf(this.space, 380);
    if (!made) return;
    const { pen, width, height } = made;
    const { at, values } = this.part;
    const [right, up, out] = this.turn.axes;
    const scale = (0.92 * Math.min(width, height)) / this.size;
    const count = at.length / 3;
    const [x, y, depth] = [new Float32Array(count), new Float32Array(count), new Float32Array(count)];
    for (let i = 0; i < count; i++) {
      const place = [0, 1, 2].map((c) => at[3 * i + c] - this.middle[c]);
      x[i] = width / 2 + scale * dot(right, place);
      y[i] = height / 2 - scale * dot(up, place);
      depth[i] = dot(out, place);
    }
    const faces = [];
    let most = 0;
    this.skins.forEach(({ corners, count: number }, body) => {
      for (let f = 0; f < number; f++) {
        const own = corners.subarray(4 * f, 4 * f + 4);
        const turned = (x[own[2]] - x[own[0]]) * (y[own[3]] - y[own[1]]) - (x[own[3]] - x[own[1]]) * (y[own[2]] - y[own[0]]);
        most = Math.max(most, values[body][f]);
        if (turned < 0) faces.push({ own, value: values[body][f], depth: own.reduce((sum, node) => sum + depth[node], 0) });
      }
    });
    faces.sort((a, b) => a.depth - b.depth);
    pen.lineWidth = 0.4;
    pen.strokeStyle = "rgb(16 16 16 / 45%)";
    for (const { own, value } of faces) {
      pen.fillStyle = `rgb(${stressColour(most > 0 ? value / most : 0)})`;
      pen.beginPath();
      for (const node of own) pen.lineTo(x[node], y[node]);
      pen.closePath();
      pen.fill();
      pen.stroke();
    }
    pen.fillStyle = getComputedStyle(this.space).color;
    pen.font = plotFont();
    pen.fillText(`t = ${digits(this.part.time)} ${this.units.time}`, 4, height - 22);
    pen.fillText(`von Mises: 0 (pale) to ${digits(most)} ${this.units.stress} (red)`, 4, height - 6);
  }

  finish(part, state, result) {
    this.result = result;
    for (const button of this.files) button.disabled = false;
    const [first, last] = [result.ledger[0], result.ledger.at(-1)];
    const line = (tag, cells) => element("tr", {}, ...cells.map((cell) => element(tag, {}, String(cell))));
    const rows = ENERGIES.map((name) => line("td", [name, first[name].toPrecision(6), last[name].toPrecision(6)]));
    this.table.replaceChildren(element("thead", {}, line("th", ["energy", "start", "end"])), element("tbody", {}, ...rows));
    const change = Math.abs(last.total - first.total) / Math.max(first.kinetic, last.kinetic, last.strain, 1e-300);
    return `The run ended at t = ${digits(part.time)} ${this.units.time}; the total energy has changed by ${(100 * change).toPrecision(2)} % of the largest part.`;
  }

  async save(kind) {
    const csv = () => new Blob([csvOf(this.result)], { type: "text/csv" });
    const file = kind === "csv" ? csv() : (await this.laboratory.remote.run("vtu", {}, () => {}))?.file;
    if (!file) return;
    const link = element("a", { href: URL.createObjectURL(file), download: `scene.${kind}` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
}

// The unit of a stress or an energy, as Units.label of Python names it.
function unitOf(quantity, given) {
  const { bases, exponents, names } = LABORATORY_TABLES.units;
  const power = (base, i) => bases[base][given[base]] ** exponents[quantity][i];
  const factor = ["length", "mass", "time"].map(power).reduce((product, each) => product * each);
  const named = names[quantity].find(([value]) => Math.abs(factor - value) <= 1e-12 * value);
  const { length, mass, time } = given;
  return named?.[1] ?? (quantity === "stress" ? `${mass}/(${length} ${time}²)` : `${mass} ${length}²/${time}²`);
}

function faultText({ line, message }) {
  return line === null ? message : `line ${line}: ${message}`;
}

// From pale to red.
function stressColour(part) {
  return [235 - 21 * part, 235 - 166 * part, 230 - 150 * part].map(Math.round);
}
