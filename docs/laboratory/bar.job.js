// A bar flies against a rigid wall: Doyen, Ern and Piperno (2011), nearer to the wall.
"use strict";

const BAR = { young: 900, density: 1, length: 10, side: 0.1, speed: 10, gap: 1, end: 1 };
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
    const end = probeRows(library, 1, 7);
    tell({
      fraction,
      time: columnOf(force, 0),
      pressure: columnOf(force, 1).map((value) => value / BAR.side ** 2),
      gap: columnOf(end, 1).map((value) => value + gap),
      energy,
    });
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
  return { ...counts, step: library.call.time_step(), touch: gap / BAR.speed };
};
