// The closest point of one face: each method's answer, the way of one, and the values that it walks over.
"use strict";

const CLOSEST = { cells: 60, reach: 1.6, certified: 8, simplex: 0, most: 400, tolerance: 1e-6 };
const PROJECTION = [
  "status", "where", "index", "evaluations", "iterations", "certified", "xi1", "xi2", "x", "y", "z", "distance",
  "signed",
];

function projected(library, point, method, start) {
  const pointer = library.call.project(...point, method, CLOSEST.tolerance, ...start);
  const values = library.doubles(pointer, PROJECTION.length);
  const found = Object.fromEntries(PROJECTION.map((name, i) => [name, values[i]]));
  const count = library.call.path_length();
  const rows = library.doubles(library.call.path_rows(), 3 * count);
  found.path = Array.from({ length: count }, (_, i) => [rows[3 * i], rows[3 * i + 1]]);
  return found;
}

// Points of the face at reference coordinates.
function facePoints(library, places) {
  library.give(places.flatMap(([a, b]) => [a, b, 0]));
  library.call.face_points(places.length);
  const rows = library.doubles(library.call.numbers(1), 3 * places.length);
  return places.map((_, i) => [rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]]);
}

function squaredDistances(library, places, point) {
  return facePoints(library, places).map((y) => y.reduce((sum, value, c) => sum + (value - point[c]) ** 2, 0));
}

// The triangles of the rolling simplex (ct_project_simplex), a step each, with the place of its lowest corner.
function rollSimplex(library, point, start) {
  const value = (place) => squaredDistances(library, [place], point)[0];
  const corners = [[-0.5, -Math.sqrt(3) / 6], [0.5, -Math.sqrt(3) / 6], [0, Math.sqrt(3) / 3]];
  let x = corners.map(([a, b]) => [start[0] + a, start[1] + b]);
  const f = x.map(value);
  const age = [0, 0, 0];
  let edge = 1;
  const order = () => {
    let high = f[0] > f[1] ? 0 : 1;
    let low = 1 - high;
    if (f[2] > f[high]) high = 2;
    else if (f[2] < f[low]) low = 2;
    return [low, 3 - low - high, high];
  };
  const reflected = (i) => {
    const [p, q] = [x[(i + 1) % 3], x[(i + 2) % 3]];
    const centre = [0, 1].map((c) => 0.5 * (p[c] + q[c]));
    return centre.map((value, c) => value + (value - x[i][c]));
  };
  const steps = [{ corners: x, low: order()[0] }];
  while (steps.length < CLOSEST.most && edge > CLOSEST.tolerance) {
    const [, second, high] = order();
    let [moved, image] = [high, reflected(high)];
    let there = value(image);
    if (there >= f[high]) {
      [moved, image] = [second, reflected(second)];
      there = value(image);
    }
    for (let k = 0; k < 3; k++) age[k]++;
    x = x.map((corner, k) => (k === moved ? image : corner));
    f[moved] = there;
    age[moved] = 0;
    const [low] = order();
    steps.push({ corners: x, low });
    if (age[low] < 3.5) continue;
    edge *= 0.5;
    age.fill(0);
    const centre = x[low];
    x = x.map((corner, k) => (k === low ? corner : corner.map((value, c) => centre[c] + 0.5 * (value - centre[c]))));
    for (let k = 0; k < 3; k++) if (k !== low) f[k] = value(x[k]);
  }
  return steps;
}

// The face as lines of constant xi, for its picture.
function faceLines(library) {
  const at = (i, count) => (2 * i) / count - 1;
  const lines = [];
  for (let i = 0; i <= 8; i++) {
    const along = Array.from({ length: 17 }, (_, j) => [at(i, 8), at(j, 16)]);
    lines.push(facePoints(library, along), facePoints(library, along.map(([a, b]) => [b, a])));
  }
  return lines;
}

JOBS.closest = async function (library, state, tell) {
  const nodes = state.nodes.slice(0, state.kind === "Q4" ? 12 : 24);
  const point = state.nodes.slice(24);
  library.give(nodes);
  library.call.set_face(state.kind === "Q4" ? 0 : 1);
  const start = [state.start1, state.start2];
  const answers = WORDS.method.map((_, method) => {
    // The sampling methods choose their start themselves.
    const own = method === CLOSEST.certified || method === WORDS.method.indexOf("robust");
    return projected(library, point, method, own ? [NaN, NaN] : start);
  });
  const at = (i) => ((i + 0.5) / CLOSEST.cells) * 2 * CLOSEST.reach - CLOSEST.reach;
  const places = Array.from({ length: CLOSEST.cells ** 2 }, (_, i) => [
    at(i % CLOSEST.cells), at(Math.floor(i / CLOSEST.cells)),
  ]);
  const values = Float32Array.from(squaredDistances(library, places, point), Math.sqrt);
  const rolled = state.method === "simplex" ? rollSimplex(library, point, start) : null;
  const way = rolled ? rolled.map(({ corners, low }) => corners[low]) : answers[word("method", state.method)].path;
  const triangles = rolled?.map(({ corners }) => corners);
  tell({ fraction: 1, answers, values, way, triangles, walk: facePoints(library, way), lines: faceLines(library) });
  return {};
};
