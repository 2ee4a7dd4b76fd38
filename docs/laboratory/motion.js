// Displacement and velocity of the nodes of a body at the start, in the order of the roundings of Python's model.
"use strict";

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross([a, b, c], [d, e, f]) {
  return [b * f - c * e, c * d - a * f, a * e - b * d];
}

// What a function makes of each row of three numbers.
function mapRows(rows, change) {
  const out = new Float64Array(rows.length);
  for (let i = 0; i < rows.length; i += 3) out.set(change(rows.subarray(i, i + 3)), i);
  return out;
}

// Smallest and largest coordinates of nodes along the three axes.
function boundsOf(nodes) {
  return [0, 1, 2].map((c) => {
    let [low, high] = [Infinity, -Infinity];
    for (let i = c; i < nodes.length; i += 3) [low, high] = [Math.min(low, nodes[i]), Math.max(high, nodes[i])];
    return [low, high];
  });
}

function middleOf(nodes) {
  return boundsOf(nodes).map(([low, high]) => 0.5 * (low + high));
}

// Whether a table "initial" gives a displacement.
function displaces({ displacement = ZERO, gradient, angle = 0 }) {
  return displacement.some((each) => each !== 0) || gradient !== undefined || angle !== 0;
}

// centre + R (1 + gradient) (X - centre) + displacement - X of all nodes X, where R turns about an axis.
function displacementsOf(nodes, { displacement = ZERO, gradient, angle = 0, axis = [0, 0, 1], centre = middleOf(nodes) }) {
  const length = Math.sqrt(dot(axis, axis));
  const e = axis.map((each) => each / length);
  const [sine, versine] = [Math.sin(angle), 2 * Math.sin(0.5 * angle) ** 2];
  return mapRows(nodes, (x) => {
    const r = [0, 1, 2].map((c) => x[c] - centre[c]);
    const stretched = gradient ? r.map((each, c) => dot(gradient[c], r) + each) : r;
    const across = cross(e, stretched);
    const twice = cross(e, across);
    return r.map((each, c) => stretched[c] - each + (sine * across[c] + versine * twice[c]) + displacement[c]);
  });
}

// v + omega x (x - centre) at all places x.
function velocitiesOf(places, velocity, { axis = [0, 0, 1], rate, centre = middleOf(places) }) {
  const length = Math.hypot(...axis);
  const omega = axis.map((each) => (rate / length) * each);
  return mapRows(places, (x) => {
    const turning = cross(omega, [0, 1, 2].map((c) => x[c] - centre[c]));
    return turning.map((each, c) => velocity[c] + each);
  });
}

// Displacements and velocities of the nodes; null where the body has none of its own.
function startOf(nodes, { velocity = ZERO, initial, spin }) {
  const displacements = initial && displaces(initial) ? displacementsOf(nodes, initial) : null;
  const places = displacements ? nodes.map((value, i) => value + displacements[i]) : nodes;
  return { displacements, velocities: spin ? velocitiesOf(places, velocity, spin) : null };
}
