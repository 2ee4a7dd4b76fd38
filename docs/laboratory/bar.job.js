// A bar flies against a rigid wall: Doyen, Ern and Piperno (2011), nearer to the wall.
"use strict";

const BAR = { young: 900, density: 1, length: 10, side: 0.1, speed: 10, gap: 1, end: 1, curve: 1000 };
BAR.sound = Math.sqrt(BAR.young / BAR.density);
BAR.pressure = BAR.density * BAR.sound * BAR.speed;
BAR.energy = 0.5 * BAR.density * BAR.length * BAR.side ** 2 * BAR.speed ** 2;
const BAR_SAMPLES = 400;

// The scene of a state of the laboratory.
function barScene(state) {
  const h = BAR.length / state.cells;
  const gap = BAR.gap + state.phase * h;
  return {
    material: [{ name: "bar", young: BAR.young, poisson: 0, density: BAR.density }],
    body: [{
      name: "bar", material: "bar", velocity: [-BAR.speed, 0, 0],
      box: { origin: [gap, 0, 0], size: [BAR.length, BAR.side, BAR.side], cells: [state.cells, 1, 1] },
    }],
    obstacle: [{
      surface: "bar.x_min", plane: { point: [0, 0, 0], normal: [1, 0, 0] },
      beta: state.beta, enforcement: state.law,
    }],
    probe: [
      { name: "force", resultant: "obstacle" },
      { name: "end", body: "bar", point: [gap, 0, 0] },
    ],
    time: { end: BAR.end, fraction: state.step, integrator: state.integrator },
  };
}

// Column `k` of the rows of a probe.
function columnOf({ count, width, rows }, k) {
  return Float64Array.from({ length: count }, (_, i) => rows[i * width + k]);
}

// Numbers of the rows that a curve of `values` needs: of each of `most` parts those of its smallest and largest value.
function thinned(values, most) {
  const width = Math.ceil(values.length / most);
  if (width < 3) return [...values.keys()];
  const out = [];
  for (let first = 0; first < values.length; first += width) {
    let [low, high] = [first, first];
    for (let i = first; i < Math.min(first + width, values.length); i++) {
      if (values[i] < values[low]) low = i;
      if (values[i] > values[high]) high = i;
    }
    out.push(Math.min(low, high), Math.max(low, high));
  }
  return out;
}

JOBS.bar = async function (library, state, tell, pause) {
  const scene = barScene(state);
  buildScene(library, scene);
  addProbes(library, scene);
  const energy = { time: [library.call.time_now()], bodies: [1], total: [1] };
  const every = Math.max(1, Math.floor(library.call.step_count() / BAR_SAMPLES));
  const gap = scene.body[0].box.origin[0];
  let shown = performance.now();
  const send = (fraction) => {
    const force = probeRows(library, 0, 4);
    const end = columnOf(probeRows(library, 1, 7), 1);
    const pressure = columnOf(force, 1).map((value) => value / BAR.side ** 2);
    const rows = thinned(pressure, BAR.curve);
    const at = (values) => Float64Array.from(rows, (i) => values[i]);
    const gaps = at(end).map((value) => value + gap);
    tell({ fraction, time: at(columnOf(force, 0)), pressure: at(pressure), gap: gaps, energy });
  };
  const counts = await advanceAll(library, every, (fraction) => {
    const now = energiesOf(library);
    if (!now) throw new LibraryError("the motion is no longer finite");
    energy.time.push(library.call.time_now());
    energy.bodies.push((now.kinetic + now.strain) / BAR.energy);
    energy.total.push((now.kinetic + now.strain + now.contact) / BAR.energy);
    if (performance.now() - shown < 100) return;
    shown = performance.now();
    send(fraction);
  }, pause);
  send(1);
  return { ...counts, step: library.call.time_step(), unit: "s", touch: gap / BAR.speed };
};
