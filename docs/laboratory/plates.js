// Two plates: the stress in both, the exact fronts over it, a line beside the closed form, the error among the prices.
"use strict";

const STRESS_NAMES = { z: "σz* (transversal)", x: "σx* (longitudinal)", xz: "τxz* (shear)" };

LABORATORIES.plates = {
  title: "Two plates",
  job: "plates",
  price,
  controls: [
    { name: "n", label: "Elements along d", values: [10, 20, 30, 40, 50, 60, 80, 100], start: 40 },
    { name: "courant", label: "Courant number", values: [0.05, 0.125, 0.25, 0.5, 0.7, 0.8, 0.9], start: 0.5 },
    { name: "law", label: "Law of the contact", words: LAW_NAMES, start: "energy_controlled" },
    { name: "beta", label: "Penalty factor β", values: [0.5, 1, 2, 4, 10, 20, 40, 100], start: 40 },
    { name: "integrator", label: "Integrator", words: INTEGRATOR_NAMES, start: "central_difference" },
    { name: "filter", label: "Filter of stress", words: { off: "off", on: "on" }, start: "off" },
    { name: "end", label: "Time c₁t/d", values: [0.1, 0.2, 0.3, 0.4, 0.5, 0.56, 0.6, 0.7, 0.8, 0.9, 1, 1.1], start: 0.56 },
    { name: "stress", label: "Stress", words: STRESS_NAMES, start: "z" },
    { name: "line", label: "Line", words: { z: "along z, x = 0.4 d", x: "along x, z = 0" }, start: "z" },
  ],
  build(laboratory) {
    return new PlatesView(laboratory);
  },
};

class PlatesView extends View {
  constructor(laboratory) {
    super();
    this.field = new Field("The stress in both plates, with the exact wave fronts over it");
    this.field.canvas.classList.add("laboratory-wide");
    this.line = new Plot({ x: "", y: "", label: "The stress along the line, computed and exact", height: 220 });
    this.prices = new Plot({
      x: "log₁₀ of the element updates", y: "log₁₀ of the error", height: 220,
      label: "Error on the line over element updates: all methods of the book, and your runs",
    });
    laboratory.pictures.append(this.field.canvas, this.line.canvas, this.prices.canvas);
    this.runs = [];
  }

  draw(part, state) {
    const stress = STRESS_NAMES[state.stress];
    this.field.draw(part.fields, state.n, 1.5, exactFronts(part.t), `${stress}, in units of Λv₀/c₁`);
    this.line.names = { x: `${state.line} / d`, y: stress };
    const curves = [
      { ...part.exact, name: "exact", dash: [4, 3] },
      { ...part.computed, name: "computed", colour: state.law === "penalty" ? "red" : "blue" },
    ];
    this.line.draw(curves, { x: [0, 1], y: rangeOf(curves.map((curve) => curve.y), [0]) });
    this.drawPrices(state);
  }

  drawPrices({ line }) {
    const log = (values) => Float64Array.from(values, Math.log10);
    const book = LABORATORY_PRICES[line];
    const own = this.runs.filter((run) => run.line === line);
    const curves = [
      { x: log(book.updates), y: log(book.error), points: true, colour: "grey", width: 0.6, name: "the book's runs" },
      { x: log(own.map((run) => run.updates)), y: log(own.map((run) => run.error)), points: true, colour: "orange", width: 3, name: "yours at c₁t/d = 0.56" },
    ];
    const x = rangeOf(curves.map((curve) => curve.x));
    this.prices.draw(curves, { x, y: rangeOf(curves.map((curve) => curve.y)) });
  }

  finish(part, state, result) {
    // The prices of the book are those of sigma_z* along z and of sigma_x* along x, at this time.
    const compared = state.end === 0.56 && state.stress === state.line;
    if (compared) this.runs.push({ line: state.line, updates: result.computed, error: result.error });
    if (this.runs.length > 100) this.runs.shift();
    this.redraw();
    return (
      `${lawName(state)}, β = ${state.beta}, Courant number ${result.courant.toPrecision(3)}` +
      `${result.limited ? " (the largest that this penalty allows)" : ""}, ` +
      `${state.n} elements along d: the mean error on the line is ${result.error.toFixed(4)} at c₁t/d = ${part.t.toFixed(2)}.`
    );
  }
}

// Lines of the exact wave fronts at c1 t / d = t in the half plate x > 0, z > 0, whose free edge is z = 1.
function exactFronts(t) {
  const c2 = Math.sqrt((1 - 2 * PLATE.poisson) / (2 * (1 - PLATE.poisson)));
  const arc = (radius) => Array.from({ length: 61 }, (_, i) => {
    const angle = (i / 60) * (Math.PI / 2);
    return [radius * Math.sin(angle), 1 - radius * Math.cos(angle)];
  });
  // The head wave touches the circle of the shear wave and meets the edge at the plane front.
  const touch = [c2 * c2 * t, 1 - c2 * t * Math.sqrt(1 - c2 * c2)];
  return [[[t, 0], [t, 1]], arc(t), arc(c2 * t), [touch, [t, 1]]];
}
