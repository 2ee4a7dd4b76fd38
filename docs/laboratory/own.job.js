// A scene of the reader's own: its run with pictures of the skins, the energy balance, and files of the results.
"use strict";

const OWN = { elements: 1e5, rows: 200, frame: 120 };

// Outer faces of all bodies: corners in the numbers of the scene, elements, and the body of each.
function skinsOf(library) {
  const call = library.call;
  return Array.from({ length: call.body_count() }, (_, body) => {
    const count = call.skin_count(body);
    const first = call.first_node(body);
    const corners = library.integers(call.skin(body), 4 * count).map((node) => node + first);
    return { count, corners, owners: library.integers(call.skin_owners(body), count) };
  });
}

function vonMises(s, e) {
  const [x, y, z, xy, yz, zx] = s.subarray(6 * e, 6 * e + 6);
  return Math.sqrt(0.5 * ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) + 3 * (xy * xy + yz * yz + zx * zx));
}

// Positions of all nodes and von Mises stress of all outer faces, now.
function pictureOf(library, skins) {
  const call = library.call;
  const count = 3 * call.node_count(-1);
  const moved = library.doubles(call.displacement(), count);
  const at = Float32Array.from(library.doubles(call.coordinates(), count), (value, i) => value + moved[i]);
  const values = skins.map(({ owners }, body) => {
    const stress = library.doubles(call.stress(body), 6 * call.element_count(body));
    return Float32Array.from(owners, (element) => vonMises(stress, element));
  });
  return { at, values };
}

JOBS.own = async function (library, scene, tell, pause) {
  buildScene(library, scene);
  const call = library.call;
  let elements = 0;
  for (let body = 0; body < call.body_count(); body++) elements += call.element_count(body);
  if (elements > OWN.elements) throw new LibraryError(`the scene has ${elements} elements; a page takes at most ${OWN.elements}`);
  addProbes(library, scene);
  const skins = skinsOf(library);
  const ledger = [{ time: 0, ...energiesOf(library) }];
  const every = Math.max(1, Math.floor(call.step_count() / OWN.rows));
  const show = (fraction) => tell({ fraction, ...pictureOf(library, skins), ledger, time: call.time_now() });
  tell({ fraction: 0, units: scene.units, skins, ...pictureOf(library, skins), ledger, time: 0 });
  let shown = performance.now();
  const counts = await advanceAll(library, every, (fraction) => {
    const now = energiesOf(library);
    if (!now) throw new LibraryError("the motion is no longer finite");
    ledger.push({ time: call.time_now(), ...now });
    if (performance.now() - shown < OWN.frame) return;
    show(fraction);
    shown = performance.now();
  }, pause);
  show(1);
  const probes = (scene.probe ?? []).map(({ name, point }, i) => ({ name, ...probeRows(library, i, point ? 7 : 4) }));
  return { ...counts, step: call.time_step(), unit: scene.units.time, ledger, probes };
};

// The last state as a VTK file of unstructured cells, in digits that give back the same numbers.
JOBS.vtu = async function (library) {
  const call = library.call;
  const nodes = call.node_count(-1);
  const rows = (values, width) => {
    const lines = [];
    for (let i = 0; i < values.length; i += width) lines.push(values.subarray(i, i + width).join(" "));
    return lines.join("\n");
  };
  const array = (name, type, width, text) =>
    `<DataArray type="${type}" Name="${name}" NumberOfComponents="${width}" format="ascii">\n${text}\n</DataArray>\n`;
  const cells = [];
  const [offsets, types, stress] = [[], [], []];
  for (let body = 0; body < call.body_count(); body++) {
    const width = call.element_nodes(body);
    const count = call.element_count(body);
    const first = call.first_node(body);
    cells.push(rows(library.integers(call.elements(body), width * count).map((node) => node + first), width));
    for (let i = 0; i < count; i++) offsets.push((offsets.at(-1) ?? 0) + width);
    types.push(...new Array(count).fill(width === 20 ? 25 : 12));
    stress.push(rows(library.doubles(call.stress(body), 6 * count), 6));
  }
  const vectors = (pointer) => rows(library.doubles(pointer, 3 * nodes), 3);
  const text =
    '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n<UnstructuredGrid>\n' +
    `<Piece NumberOfPoints="${nodes}" NumberOfCells="${types.length}">\n<Points>\n` +
    array("Points", "Float64", 3, vectors(call.coordinates())) +
    "</Points>\n<Cells>\n" +
    array("connectivity", "Int32", 1, cells.join("\n")) +
    array("offsets", "Int32", 1, offsets.join(" ")) +
    array("types", "UInt8", 1, types.join(" ")) +
    "</Cells>\n<PointData>\n" +
    array("displacement", "Float64", 3, vectors(call.displacement())) +
    array("velocity", "Float64", 3, vectors(call.velocity())) +
    "</PointData>\n<CellData>\n" +
    array("stress", "Float64", 6, stress.join("\n")) +
    "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return { file: new Blob([text], { type: "application/xml" }) };
};

// The energy balance as a table, and below it one for each probe.
function csvOf({ ledger, probes }) {
  const names = ["time", ...ENERGIES];
  const parts = [[names.join(","), ...ledger.map((row) => names.map((name) => row[name]).join(","))].join("\n")];
  for (const { name, width, count, rows } of probes) {
    const columns = width === 7 ? ["ux", "uy", "uz", "vx", "vy", "vz"] : ["fx", "fy", "fz"];
    const quoted = `"${name.replaceAll('"', '""')}"`;
    const lines = Array.from({ length: count }, (_, i) => rows.subarray(i * width, (i + 1) * width).join(","));
    parts.push([`# ${quoted}`, ["time", ...columns].join(","), ...lines].join("\n"));
  }
  return `${parts.join("\n\n")}\n`;
}
