// Two thick plates collide: Gabriel, Kopačka, Plešek and Ulbin (2012), half of each plate, one layer in plane strain.
"use strict";

const PLATE = { young: 2.1e5, poisson: 0.3, density: 7.8e-9, d: 2.5, speed: 1000, frames: 40 };
PLATE.lame = (PLATE.young * PLATE.poisson) / ((1 + PLATE.poisson) * (1 - 2 * PLATE.poisson));
PLATE.c1 = speedOf(PLATE);
// A stress in the paper's unit, Lambda v0 / c1.
PLATE.stress = (PLATE.lame * PLATE.speed) / PLATE.c1;
const PLATE_COMPONENTS = { x: 0, z: 2, xz: 5 };

// The scene with a step { courant } or { fraction }.
function platesScene(state, step) {
  const { n } = state;
  const body = (name, origin, speed) => ({
    name, material: "steel", velocity: [speed, 0, 0],
    box: { origin, size: [PLATE.d, PLATE.d / n, PLATE.d], cells: [n, 1, n] },
  });
  const held = (name) => [
    { set: `${name}.z_min`, fix: ["z"] }, { set: `${name}.y_min`, fix: ["y"] }, { set: `${name}.y_max`, fix: ["y"] },
  ];
  return {
    material: [{ name: "steel", young: PLATE.young, poisson: PLATE.poisson, density: PLATE.density }],
    body: [body("left", [-PLATE.d, 0, 0], PLATE.speed), body("right", [0, 0, 0], -PLATE.speed)],
    contact: [{ surfaces: ["left.x_max", "right.x_min"], beta: state.beta, enforcement: state.law }],
    support: [...held("left"), ...held("right")],
    time: {
      end_c1t_over: { length: PLATE.d, value: state.end },
      ...step,
      integrator: state.integrator,
    },
  };
}

// The stresses of the elements of a body by column and row, element (i, k) in column i of x and row k of z.
function plateField(library, scene, body, n, component, filtered) {
  const call = library.call;
  const stress = filtered ? call.filtered_stress(body, 1) : call.stress(body);
  const values = library.doubles(stress, 6 * n * n);
  const layers = layersOf(scene, scene.body[body]);
  const field = new Float32Array(n * n);
  for (let k = 0; k < n; k++) {
    for (let i = 0; i < n; i++) {
      const element = layers === "x" ? k + n * i : i + n * k;
      field[i + n * k] = values[6 * element + component] / PLATE.stress;
    }
  }
  return field;
}

// The exact stresses along a line at a time t of c1 t / d.
function exactLine(library, points, t, component) {
  library.give(points.flatMap(([x, z]) => [x, z, t, 0, 0]));
  library.check(library.call.exact_plates(points.length, PLATE.poisson));
  const rows = library.doubles(library.call.numbers(1), 5 * points.length);
  return Float64Array.from(points, (_, i) => rows[5 * i + { 0: 0, 2: 1, 5: 2 }[component]]);
}

// Points of a line in d: along z at x = 0.4, or along x next to the plane of symmetry.
function linePoints(line, count, n) {
  const at = (i) => (i + 0.5) / count;
  return Array.from({ length: count }, (_, i) => (line === "z" ? [0.4, at(i)] : [at(i), 0.5 / n]));
}

// The computed stress there: at x = 0.4 the mean of the columns of elements on both sides.
function computedLine(field, line, n) {
  const column = Math.round(0.4 * n);
  return Float64Array.from({ length: n }, (_, i) =>
    line === "z" ? 0.5 * (field[column - 1 + n * i] + field[column + n * i]) : field[i],
  );
}

// Build the scene; whether the step had to be that of the stable one, which a stiff penalty makes shorter.
function buildPlates(library, state) {
  try {
    buildScene(library, platesScene(state, { courant: state.courant }));
    return false;
  } catch (error) {
    if (!(error instanceof LibraryError)) throw error;
    buildScene(library, platesScene(state, { fraction: 0.98 }));
    return true;
  }
}

JOBS.plates = async function (library, state, tell, pause) {
  const scene = platesScene(state);
  const component = PLATE_COMPONENTS[state.stress];
  const { n, line } = state;
  const limited = buildPlates(library, state);
  const frame = (fraction) => {
    const t = (library.call.time_now() * PLATE.c1) / PLATE.d;
    const filtered = state.filter === "on";
    const fields = [0, 1].map((body) => plateField(library, scene, body, n, component, filtered));
    const own = linePoints(line, n, n);
    const fine = linePoints(line, 400, n);
    const computed = computedLine(fields[1], line, n);
    const exact = exactLine(library, own, t, component);
    const error = computed.reduce((sum, value, i) => sum + Math.abs(value - exact[i]), 0) / n;
    const place = (points) => Float64Array.from(points, ([x, z]) => (line === "z" ? z : x));
    tell({
      fraction, t, fields, error,
      computed: { x: place(own), y: computed },
      exact: { x: place(fine), y: exactLine(library, fine, t, component) },
    });
    return error;
  };
  const every = Math.max(1, Math.floor(library.call.step_count() / PLATE.frames));
  let error = 0;
  const counts = await advanceAll(library, every, (fraction) => (error = frame(fraction)), pause);
  const energy = energiesOf(library);
  const step = library.call.time_step();
  return { ...counts, error, step, unit: "s", limited, courant: step / library.call.stable_step(2), energy };
};
