// Waves in a mesh of cubes with edge 1: speed over wavelength, and the front of a step, beside a run of the library.
"use strict";

const WAVES = { poisson: 0.3, points: 120, fine: 400 };
WAVES.c1 = speedOf({ young: 1, poisson: WAVES.poisson, density: 1 });

// Phase velocities of the P wave over c1, and group velocities by differences, at edges per wavelength up to one half.
function speedsOf(library, state, normal) {
  const kind = word("element", state.element);
  const branches = kind === 1 ? 12 : 3;
  const length = Math.hypot(...normal);
  const part = Float64Array.from({ length: WAVES.points }, (_, i) => (0.5 * (i + 1)) / WAVES.points);
  const waves = [...part].flatMap((value) => normal.map((each) => (2 * Math.PI * value * each) / length));
  library.numbers(2 * branches * WAVES.points);
  library.give(waves);
  const scheme = word("integrator", state.integrator);
  library.check(library.call.dispersion(kind, WAVES.poisson, scheme, state.courant, WAVES.points));
  const rows = library.doubles(library.call.numbers(1), 2 * branches * WAVES.points);
  const omega = Float64Array.from(part, (_, i) => rows[2 * (branches * i + 2)]);
  const phase = omega.map((value, i) => value / (2 * Math.PI * part[i] * WAVES.c1));
  const group = omega.map((value, i) => (value - (omega[i - 1] ?? 0)) / (2 * Math.PI * part[0] * WAVES.c1));
  return { part, phase, group };
}

// The stress behind the front of a half space that has hit a wall, by the sum of all waves, over - rho c1 v0.
function frontOf(library, state, normal) {
  const steps = stepsOf(state);
  const most = state.distance * 1.25;
  const place = Float64Array.from({ length: WAVES.fine }, (_, i) => (most * (i + 0.5)) / WAVES.fine);
  library.numbers(2 * WAVES.fine);
  library.give(place);
  const kind = word("element", state.element);
  const scheme = word("integrator", state.integrator);
  library.check(library.call.front(kind, WAVES.poisson, scheme, state.courant, ...normal, steps, WAVES.fine));
  const both = library.doubles(library.call.numbers(1), 2 * WAVES.fine);
  return { place, stress: both.slice(WAVES.fine) };
}

// Whole number of steps in which the exact front travels the distance; sixteen an edge in continuous time.
function stepsOf({ courant, distance }) {
  return Math.max(1, Math.round(courant > 0 ? distance / courant : 16 * distance));
}

// A row of elements in uniaxial strain that hits a wall, run by the library.
function rowScene(state) {
  const cells = Math.ceil(1.5 * state.distance);
  const held = ["y_min", "y_max", "z_min", "z_max"].map((face) => ({ set: `row.${face}`, fix: [face[0]] }));
  return {
    material: [{ name: "row", young: 1, poisson: WAVES.poisson, density: 1 }],
    body: [{
      name: "row", material: "row", element: state.element, velocity: [-1, 0, 0],
      box: { size: [cells, 1, 1], cells: [cells, 1, 1] },
    }],
    support: [{ set: "row.x_min", fix: ["x"] }, ...held],
    time: {
      end: (stepsOf(state) * state.courant) / WAVES.c1, dt: state.courant / WAVES.c1, integrator: state.integrator,
    },
  };
}

async function runRow(library, state, pause) {
  const scene = rowScene(state);
  buildScene(library, scene);
  const counts = await advanceAll(library, 64, () => {}, pause);
  const cells = scene.body[0].box.cells[0];
  const values = library.doubles(library.call.stress(0), 6 * cells);
  const place = Float64Array.from({ length: cells }, (_, i) => i + 0.5);
  return { counts, place, stress: place.map((_, i) => -values[6 * i] / WAVES.c1) };
}

JOBS.waves = async function (library, state, tell, pause) {
  const normal = state.direction.split("").map(Number);
  const speeds = speedsOf(library, state, normal);
  const front = frontOf(library, state, normal);
  const part = { fraction: 0.5, speeds, front, row: null, why: "" };
  tell(part);
  if (state.courant > 0 && state.direction === "100") {
    try {
      part.row = await runRow(library, state, pause);
    } catch (error) {
      if (!(error instanceof LibraryError)) throw error;
      part.why = error.message;
    }
  } else {
    part.why = "A run needs a step, and the direction of an axis.";
  }
  tell({ ...part, fraction: 1 });
  return part.row?.counts ?? {};
};
