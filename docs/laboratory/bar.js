// A wall and a bar: pressure, energy and gap of each law, penalty and step.
"use strict";

const LAW_NAMES = { energy_controlled: "energy-controlled", penalty: "explicit penalty" };
const INTEGRATOR_NAMES = {
  central_difference: "central difference", chung_lee: "Chung–Lee", noh_bathe: "Noh–Bathe",
  tchamwa_wielgosz: "Tchamwa–Wielgosz",
};

// The law in a caption.
function lawName({ law }) {
  return law === "penalty" ? "Explicit penalty" : "Energy-controlled penalty (the default)";
}

LABORATORIES.bar = {
  title: "A wall and a bar",
  job: "bar",
  price,
  controls: [
    { name: "law", label: "Law of the contact", words: LAW_NAMES, start: "energy_controlled" },
    { name: "beta", label: "Penalty factor β", values: [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000], start: 5 },
    { name: "step", label: "Step over the stable step", values: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98], start: 0.9 },
    { name: "integrator", label: "Integrator", words: INTEGRATOR_NAMES, start: "central_difference" },
    { name: "cells", label: "Elements of the bar", values: [10, 20, 50, 100, 200, 400], start: 100 },
    { name: "phase", label: "Landing phase, in elements", unit: "h", values: [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9], start: 0 },
  ],
  build(laboratory) {
    return new BarView(laboratory);
  },
};

class BarView extends View {
  constructor(laboratory) {
    super();
    const x = "time t [s]";
    this.pressure = new Plot({ x, y: "pressure [Pa]", label: "Pressure on the wall over time, with the exact step" });
    this.energy = new Plot({ x, y: "energy / start", label: "Energy of the bar over its start, over time" });
    this.gap = new Plot({ x, y: "gap / h", label: "Gap between bar and wall over time, in element sizes" });
    // One below the other, over the same time.
    const all = [this.pressure, this.energy, this.gap].map(({ canvas }) => canvas);
    for (const canvas of all) canvas.classList.add("laboratory-wide");
    laboratory.pictures.append(...all);
    this.before = null;
  }

  draw(part, state) {
    const h = BAR.length / state.cells;
    const touch = (BAR.gap + state.phase * h) / BAR.speed;
    const leave = touch + (2 * BAR.length) / BAR.sound;
    const x = [0, BAR.end];
    const old = this.before?.part;
    const exact = { x: [0, touch, touch, leave, leave, BAR.end], y: [0, 0, 1, 1, 0, 0].map((on) => on * BAR.pressure) };
    const name = LAW_NAMES[state.law];
    const lines = (key) => [
      ...(old ? [{ ...key(old, this.before.state), colour: "grey", name: "before", width: 1 }] : []),
      { ...key(part, state), colour: state.law === "penalty" ? "red" : "blue", name },
    ];
    const pressures = lines((from) => ({ x: from.time, y: from.pressure }));
    pressures.push({ ...exact, dash: [4, 3], name: "exact" });
    this.pressure.draw(pressures, { x, y: rangeOf(pressures.map((curve) => curve.y), [0]) });
    const energies = lines((from) => ({ x: from.energy.time, y: from.energy.total }));
    energies.push({ x, y: [1, 1], dash: [4, 3], name: "exact" });
    this.energy.draw(energies, { x, y: rangeOf(energies.map((curve) => curve.y), [0.9, 1.1]) });
    const gaps = lines((from, own) => ({ x: from.time, y: from.gap.map((value) => (value * own.cells) / BAR.length) }));
    this.gap.draw(gaps, { x, y: [-1, 4] });
  }

  finish(part, state, result) {
    const end = part.energy.total[part.energy.total.length - 1];
    const peak = Math.max(...part.pressure) / BAR.pressure;
    this.before = { part, state };
    return (
      `${lawName(state)}, β = ${state.beta}, step ${state.step} of the stable one: ` +
      `the energy at the end is ${end.toFixed(3)} times that of the start, ` +
      `the largest pressure ${peak.toFixed(2)} times the exact one.`
    );
  }
}
