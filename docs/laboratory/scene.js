// From the tables of a scene, named as in a scene file and already checked, to the library.
"use strict";

const SIDES = ["", "x_min", "x_max", "y_min", "y_max", "z_min", "z_max", "outer"];
const WORDS = {
  element: ["hex8", "hex20"],
  law: ["linear", "st_venant_kirchhoff", "neo_hookean"],
  enforcement: ["penalty", "energy_controlled"],
  method: [
    "simplex", "nelder_mead", "newton", "least_squares", "steepest_descent", "broyden", "bfgs",
    "robust", "certified", "simplex_newton", "sphere", "torus",
  ],
  points: ["gauss", "lobatto"],
  initial_penetration: ["force", "refuse", "keep", "remove"],
  integrator: ["central_difference", "chung_lee", "noh_bathe", "tchamwa_wielgosz"],
  layers: ["z", "x", "y"],
  shape: ["plane", "sphere", "cylinder"],
};
const ZERO = [0, 0, 0];
// Boxes with shorter rows are numbered along z.
const SHORTEST_ROW = 32;

// The number of a word in C; -1: none is given.
function word(kind, name) {
  return name === undefined ? -1 : WORDS[kind].indexOf(name);
}

// Axes as the bits 1, 2, 4.
function bitsOf(axes) {
  return axes.reduce((sum, axis) => sum + (1 << "xyz".indexOf(axis)), 0);
}

// The face of a surface such as "left.x_max" and the number of its body.
function surfaceOf(scene, name) {
  const dot = name.lastIndexOf(".");
  const body = scene.body.findIndex((each) => each.name === name.slice(0, dot));
  return [body, SIDES.indexOf(name.slice(dot + 1))];
}

// The axis along which layers of a box follow one another: normal to the faces with a contact, an obstacle or a load.
function layersOf(scene, body) {
  if (body.box.layers) return body.box.layers;
  const pressed = (scene.contact ?? []).flatMap((each) => each.surfaces);
  for (const each of [...(scene.obstacle ?? []), ...(scene.load ?? [])]) pressed.push(each.surface);
  const own = pressed.filter((name) => name.slice(0, name.lastIndexOf(".")) === body.name);
  const axes = new Set(own.map((name) => name[name.lastIndexOf(".") + 1]));
  const axis = axes.size === 1 ? [...axes][0] : "z";
  if (axis !== "x" && axis !== "y") return "z";
  const others = axis === "x" ? [1, 2] : [0, 2];
  const row = Math.max(...others.map((i) => body.box.cells[i]));
  return row >= SHORTEST_ROW ? axis : "z";
}

// The mesh of a body, made by the library.
function meshBody(library, scene, body, kind) {
  const call = library.call;
  const shape = ["box", "ring", "cylinder", "ball", "shell"].find((name) => body[name]);
  const given = body[shape];
  const centre = given.centre ?? ZERO;
  if (shape === "box") {
    const layers = word("layers", layersOf(scene, body));
    const origin = given.origin ?? ZERO;
    call.set_grading(...(given.grading ?? ZERO), bitsOf(given.symmetric ?? []));
    library.check(call.mesh_box(kind, ...origin, ...given.size, ...given.cells, layers));
  } else if (shape === "ring") {
    library.check(call.mesh_ring(kind, ...centre, ...given.radius, given.width, ...given.cells));
  } else if (shape === "cylinder") {
    library.check(call.mesh_cylinder(kind, ...centre, given.radius, given.width, ...given.cells));
  } else {
    const radius = shape === "ball" ? [0, given.radius] : given.radius;
    library.check(call.mesh_ball(kind, ...centre, ...radius, ...given.cells));
  }
}

function addBody(library, scene, body) {
  const call = library.call;
  const material = scene.material.find((each) => each.name === body.material);
  const law = Math.max(word("law", material.law), 0);
  call.set_material(material.young, material.poisson, material.density, law);
  const reduced = body.integration === "reduced" ? 4 : 0;
  call.set_motion(...(body.velocity ?? ZERO), reduced);
  const damping = scene.damping?.bodies?.includes(body.name) === false ? 0 : (scene.damping?.stiffness ?? 0);
  call.set_state(damping, ...(body.initial?.stress ?? [...ZERO, ...ZERO]));
  meshBody(library, scene, body, Math.max(word("element", body.element), 0));
  const moves = startOf(library.doubles(call.mesh_nodes(), 3 * call.mesh_node_count()), body);
  const rows = [moves.displacements, moves.velocities].filter(Boolean);
  if (rows.length) library.give(rows.flatMap((each) => [...each]));
  library.check(call.add_body(Number(moves.displacements !== null), Number(moves.velocities !== null)));
}

// What a contact or an obstacle says of its law, with the defaults of the scene's integrator.
function setLaw(library, given, leapfrog) {
  const feeds = given.enforcement === "penalty";
  const restitution = given.restitution ?? (leapfrog || feeds ? -1 : 0);
  library.call.set_law(
    word("enforcement", given.enforcement), given.beta ?? 0, given.epsilon ?? 0,
    given.dissipation ?? -1, restitution, given.friction ?? 0, given.tangent ?? 0,
    word("initial_penetration", given.initial_penetration),
  );
  library.call.set_search(word("method", given.method), word("points", given.points), given.adjust ?? 0);
}

function setHistory(library, history) {
  const count = history ? history.time.length : 0;
  library.give(history ? history.time.flatMap((time, i) => [time, history.value[i]]) : [0, 0]);
  if (library.call.set_history(count)) throw new LibraryError("a history has at most 64 points here");
}

function addObstacle(library, scene, given, leapfrog) {
  const shape = WORDS.shape.findIndex((name) => given[name]);
  const solid = given[WORDS.shape[shape]];
  const axis = solid.normal ?? solid.axis ?? [0, 0, 1];
  setLaw(library, given, leapfrog);
  setHistory(library, given.history);
  const numbers = [solid.point ?? solid.centre, axis, given.velocity ?? ZERO, given.travel ?? ZERO];
  library.give(numbers.flat());
  library.check(library.call.add_obstacle(...surfaceOf(scene, given.surface), shape, solid.radius ?? 0));
}

function addLoad(library, scene, given) {
  setHistory(library, given.history);
  const traction = given.traction ?? ZERO;
  const pressure = given.pressure ?? 0;
  const on = surfaceOf(scene, given.surface);
  library.check(library.call.add_load(...on, ...traction, pressure, given.following ? 1 : 0));
}

function addSupport(library, scene, given) {
  const on = surfaceOf(scene, given.set);
  library.check(library.call.add_support(...on, bitsOf(given.fix), ...(given.velocity ?? ZERO)));
}

// The end of a run; a distance that the fastest wave of all bodies travels may give it.
function endOf(scene) {
  if (scene.time.end !== undefined) return scene.time.end;
  const over = scene.time.end_c1t_over;
  return (over.length * over.value) / Math.max(...usedMaterials(scene).map(speedOf));
}

function usedMaterials(scene) {
  return scene.material.filter((each) => scene.body.some((body) => body.material === each.name));
}

// The speed c1 of the dilatational wave, in the order of the library's roundings.
function speedOf({ young, poisson, density }) {
  const lambda = (young * poisson) / ((1 + poisson) * (1 - 2 * poisson));
  const mu = young / (2 * (1 + poisson));
  return Math.sqrt((lambda + 2 * mu) / density);
}

// Build the scene in the library, whose run then stands at its start.
function buildScene(library, scene) {
  const call = library.call;
  call.clear_probes();
  library.check(call.begin());
  for (const body of scene.body) addBody(library, scene, body);
  library.check(call.join());
  const time = scene.time;
  const scheme = Math.max(word("integrator", time.integrator), 0);
  const parameter = time.integrator_parameter ?? NaN;
  const leapfrog = call.is_leapfrog(scheme, parameter) !== 0;
  for (const contact of scene.contact ?? []) {
    const [first, second] = contact.surfaces.map((name) => surfaceOf(scene, name));
    setLaw(library, contact, leapfrog);
    library.check(call.add_contact(...first, ...second));
  }
  for (const support of scene.support ?? []) addSupport(library, scene, support);
  for (const obstacle of scene.obstacle ?? []) addObstacle(library, scene, obstacle, leapfrog);
  if (scene.gravity) {
    setHistory(library, scene.gravity.history);
    library.check(call.add_gravity(...scene.gravity.acceleration));
  }
  for (const load of scene.load ?? []) addLoad(library, scene, load);
  if (scene.damping?.rate !== undefined) {
    const on = (scene.damping.bodies ?? []).map((name) => scene.body.findIndex((body) => body.name === name));
    new Int32Array(call.memory.buffer, call.numbers(on.length), on.length).set(on);
    library.check(call.add_damping(scene.damping.rate, on.length));
  }
  const how = ["courant", "fraction", "dt"].findIndex((name) => time[name] !== undefined);
  const usual = usedMaterials(scene).some((each) => (each.law ?? "linear") !== "linear") ? 0.7 : 0.9;
  const value = how < 0 ? usual : time[["courant", "fraction", "dt"][how]];
  library.check(call.start(endOf(scene), how < 0 ? 1 : how, value, scheme, parameter));
}

function addProbe(library, scene, probe) {
  const every = probe.every ?? 1;
  if (probe.point) {
    const body = scene.body.findIndex((each) => each.name === probe.body);
    library.check(library.call.probe_point(body, ...probe.point, every));
    return;
  }
  const [, table, number] = /^(contact|obstacle)(?:\[(\d+)\])?$/.exec(probe.resultant);
  const part = scene[table][number ?? 0];
  const own = probe.body ?? (part.surface ?? part.surfaces[0]).split(".")[0];
  const body = scene.body.findIndex((each) => each.name === own);
  const obstacle = table === "obstacle" ? 1 : 0;
  library.check(library.call.probe_force(body, obstacle, Number(number ?? 0), every));
}

// Record the probes of the scene from here on.
function addProbes(library, scene) {
  for (const probe of scene.probe ?? []) addProbe(library, scene, probe);
  if (scene.probe?.length) library.check(library.call.start_probes());
}

// Rows of a probe: the time, then displacement and velocity of a point, or a force.
function probeRows(library, number, width) {
  const count = library.call.probe_row_count(number);
  const rows = library.doubles(library.call.probe_rows(number), count * width);
  return { count, width, rows };
}

const ENERGIES = ["kinetic", "strain", "contact", "external", "total", "balance", "reserve"];

// The energy balance now, or null where it is no longer finite.
function energiesOf(library) {
  const pointer = library.call.energies();
  if (pointer === 0) return null;
  const values = library.doubles(pointer, ENERGIES.length);
  return Object.fromEntries(ENERGIES.map((name, i) => [name, values[i]]));
}
