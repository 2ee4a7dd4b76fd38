// Waves: the speed of each wave in a mesh, and the front of a step after a distance, beside a run.
"use strict";

LABORATORIES.waves = {
  title: "Waves",
  job: "waves",
  price: ({ steps, elements }) => (steps ? `the run: ${steps} steps of ${elements} elements` : ""),
  controls: [
    { name: "element", label: "Elements", words: { hex8: "hex8", hex20: "hex20" }, start: "hex8" },
    { name: "courant", label: "Courant number (0: no steps)", values: [0, 0.1, 0.125, 0.2, 0.25, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1], start: 0.125 },
    { name: "integrator", label: "Integrator", words: INTEGRATOR_NAMES, start: "central_difference" },
    { name: "direction", label: "Direction of the wave", words: { 100: "an axis", 110: "a diagonal of a face", 111: "a diagonal of the cube" }, start: "100" },
    { name: "distance", label: "Distance of the front", unit: "h", values: [5, 10, 20, 40, 56, 80, 120, 200], start: 56 },
  ],
  build(laboratory) {
    return new WavesView(laboratory);
  },
};

class WavesView extends View {
  constructor(laboratory) {
    super();
    this.speeds = new Plot({
      x: "edges per wavelength h/ℓ", y: "speed / c₁", height: 240,
      label: "Phase and group velocity of the P wave over the edges per wavelength",
    });
    this.front = new Plot({
      x: "distance from the wall / h", y: "stress / ρc₁v₀", height: 240,
      label: "The stress behind the front: exact, by the sum of all waves, and from a run",
    });
    laboratory.pictures.append(this.speeds.canvas, this.front.canvas);
  }

  draw(part, state) {
    const { speeds, front, row } = part;
    this.speeds.draw([
      { x: [0, 0.5], y: [1, 1], dash: [4, 3], name: "exact" },
      { x: speeds.part, y: speeds.phase, colour: "blue", name: "phase" },
      { x: speeds.part, y: speeds.group, colour: "orange", name: "group" },
    ], { x: [0, 0.5], y: [-0.1, 1.4] });
    const d = state.distance;
    const curves = [
      { x: [0, d, d, 1.25 * d], y: [1, 1, 0, 0], dash: [4, 3], name: "exact" },
      { x: front.place, y: front.stress, colour: "blue", name: "sum of all waves" },
    ];
    if (row) curves.push({ x: row.place, y: row.stress, colour: "orange", points: true, width: 1, name: "run of the library" });
    this.front.draw(curves, { x: [0, 1.25 * d], y: [-0.3, 1.6] });
  }

  finish(part, state) {
    const { place, stress } = part.front;
    const peak = Math.max(...stress);
    const at = stress.findLastIndex((value) => value >= 0.5);
    const late = state.distance - place[Math.max(at, 0)];
    const off = part.row ? differenceOf(part.front, part.row) : null;
    const compared = off === null ? part.why : `The run differs from the sum by at most ${off.toFixed(3)}.`;
    return (
      `${state.element}, ${INTEGRATOR_NAMES[state.integrator]}, Courant number ${state.courant}: after ${state.distance} h the ` +
      `front is ${late.toFixed(2)} h late and the stress overshoots by ${(100 * (peak - 1)).toFixed(1)} %. ${compared}`
    );
  }
}

// Largest difference of a run from the sum of waves, read between its places.
function differenceOf(front, row) {
  const gap = front.place[1] - front.place[0];
  let largest = 0;
  row.place.forEach((place, i) => {
    const at = (place - front.place[0]) / gap;
    const below = Math.floor(at);
    if (below < 0 || below + 1 >= front.place.length) return;
    const weight = at - below;
    const value = (1 - weight) * front.stress[below] + weight * front.stress[below + 1];
    largest = Math.max(largest, Math.abs(value - row.stress[i]));
  });
  return largest;
}
