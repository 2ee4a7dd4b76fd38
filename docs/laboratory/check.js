// The check of a scene by the tables of Python's model (LABORATORY_TABLES, tools/page_tables.py), in the order and with
// the words of Python's reader. The result has plain values.
"use strict";

const NOT_HERE = "is a key of the library that a page does not compute; run this scene with the library";
const WITHIN = { above: (a, b) => a > b, "at least": (a, b) => a >= b, below: (a, b) => a < b, "at most": (a, b) => a <= b };
const LONGEST_NAME = 63;

// A place in a scene, such as body[1].material. `names` are those of bodies that have dots.
class Place {
  constructor(key, names) {
    Object.assign(this, { key, names });
  }

  of(name) {
    return new Place(this.key ? `${this.key}.${name}` : name, this.names);
  }

  entry(i) {
    return new Place(`${this.key}[${i}]`, this.names);
  }

  fail(reason) {
    throw new SceneFault(reason, this.key);
  }

  need(holds, node, what) {
    if (!holds) this.fail(`is ${describe(node)}; it must be ${what}`);
  }
}

const isNumber = (node) => node.type === "integer" || node.type === "float";

// The value of a key by the kind of its values.
const READ = {
  Number(node, at, kind) {
    at.need(isNumber(node), node, "a number");
    at.need(Number.isFinite(node.value), node, "a finite number");
    for (const [name, limit] of kind.limits) {
      at.need(WITHIN[name](node.value, limit), node, `${name} ${shortNumber(limit)}${kind.why}`);
    }
    return node.value;
  },
  Whole(node, at, kind) {
    at.need(node.type === "integer", node, "a whole number");
    at.need(node.value >= kind.least && node.value <= kind.most, node, `from ${kind.least} to ${kind.most}`);
    at.need(node.value % kind.step === 0, node, `a multiple of ${kind.step}`);
    return node.value;
  },
  Flag(node, at, kind) {
    const right = node.type === "boolean" && (node.value || !kind.only);
    at.need(right, node, `true${kind.only || " or false"}`);
    return node.value;
  },
  Text(node, at) {
    at.need(node.type === "string", node, "a text");
    return node.value;
  },
  FileName(node, at) {
    const name = READ.Text(node, at);
    if (!name || name.includes("\0")) at.fail("is no file name");
    return name;
  },
  Name(node, at) {
    const name = READ.Text(node, at);
    if (!name || /[\p{C}\p{Zl}\p{Zp}]|[^\P{Zs} ]/u.test(name) || name !== name.trim()) {
      at.fail(`${pythonText(name)} is no name; use printable characters without blanks at the ends`);
    }
    const { length } = new TextEncoder().encode(name);
    if (length > LONGEST_NAME) at.fail(`is ${length} bytes long; at most ${LONGEST_NAME} are kept`);
    return name;
  },
  Reference(node, at, kind, seen) {
    at.need(node.type === "string", node, `the name of a [[${kind.table}]]`);
    seen.push({ at, table: kind.table, name: node.value });
    return node.value;
  },
  Surface(node, at, _, seen) {
    at.need(node.type === "string", node, 'a text such as "left.x_max"');
    const found = splitSurface(node.value, at.names);
    if (!found) at.fail(`"${node.value}" is no face; write body and face with a dot, such as "left.x_max"`);
    const [body, face] = found;
    seen.push({ at, table: "body", name: body, face });
    return `${body}.${face}`;
  },
  PartKey(node, at, kind) {
    const text = READ.Text(node, at);
    const found = /^(\w+)(?:\[([0-9]{1,9})\])?$/.exec(text);
    if (!found || !kind.tables.includes(found[1])) {
      const near = suggestion(text.split("[")[0], kind.tables, "it must be ");
      at.fail(`"${text}" is no part of a scene that has a resultant${near}`);
    }
    if (found[1] === "support") at.fail(NOT_HERE);
    return text;
  },
  Choice(node, at, kind) {
    const chosen = READ.Text(node, at);
    if (!kind.known.includes(chosen)) {
      const unknown = `is unknown${suggestion(chosen, kind.known, "it must be ")}`;
      at.fail(`"${chosen}" ${kind.gone[chosen] ?? unknown}`);
    }
    return chosen;
  },
  Each(node, at, kind, seen) {
    at.need(node.type === "array", node, `a list of ${kind.kinds.length}`);
    const { length } = node.value;
    if (length !== kind.kinds.length) at.fail(`has ${length} entries; it must have ${kind.kinds.length}`);
    return kind.kinds.map((each, i) => readKind(node.value[i], at.entry(i), each, seen));
  },
  Many(node, at, kind, seen) {
    at.need(node.type === "array", node, "a list");
    if (kind.none && node.value.length === 0) at.fail(`is empty; ${kind.none}`);
    const found = [];
    node.value.forEach((each, i) => {
      const value = readKind(each, at.entry(i), kind.of, seen);
      if (kind.distinct && found.includes(value)) at.entry(i).fail(`"${value}" is named twice`);
      found.push(value);
    });
    return kind.of.kind === "Choice" ? [...new Set(found)] : found;
  },
  Nested(node, at, kind, seen) {
    return readTable(node, at, kind.table, seen);
  },
  Several(node, at, kind, seen) {
    at.need(node.type === "array", node, `an array of tables, written [[${at.key}]]`);
    return node.value.map((each, i) => readTable(each, at.entry(i), kind.table, seen));
  },
};

function readKind(node, at, kind, seen) {
  return READ[kind.kind](node, at, kind, seen);
}

// Body and face of "left.x_max"; both names may have dots.
function splitSurface(text, dotted) {
  const last = text.lastIndexOf(".");
  let [body, face] = last < 0 ? ["", ""] : [text.slice(0, last), text.slice(last + 1)];
  if (!LABORATORY_TABLES.faces.includes(face)) {
    const first = text.indexOf(".");
    [body, face] = first < 0 ? [text, ""] : [text.slice(0, first), text.slice(first + 1)];
    for (const name of dotted) {
      if (text.startsWith(`${name}.`) && name.length > body.length) [body, face] = [name, text.slice(name.length + 1)];
    }
  }
  return body && face ? [body, face] : null;
}

function needed(table) {
  return Object.keys(table.keys).filter((key) => table.keys[key].required);
}

function describedTable(table) {
  return `a table${needed(table).length ? ` with ${listed(needed(table), "and")}` : ""}`;
}

function readTable(node, at, name, seen) {
  const table = LABORATORY_TABLES.tables[name];
  const known = Object.keys(table.keys);
  at.need(node.type === "table", node, describedTable(table));
  for (const key of node.value.keys()) {
    if (!known.includes(key)) at.of(key).fail(`unknown key${suggestion(key, known)}`);
  }
  for (const key of needed(table)) {
    if (node.value.has(key)) continue;
    const kind = table.keys[key];
    const must = kind.kind === "Nested" ? `; it must be ${describedTable(LABORATORY_TABLES.tables[kind.table])}` : "";
    at.of(key).fail(`is missing${must}`);
  }
  readAlternatives(node, at, table);
  const out = {};
  seen.push({ at, model: name, value: out });
  for (const key of known) {
    if (!node.value.has(key)) continue;
    const value = node.value.get(key);
    if (!table.keys[key].kept) at.of(key).fail(NOT_HERE);
    out[key] = readKind(value, at.of(key), table.keys[key], seen);
  }
  return out;
}

// Combinations of keys.
function readAlternatives(node, at, table) {
  for (const group of [...table.one, ...table.rivals]) {
    const there = group.filter((key) => node.value.has(key));
    if (there.length > 1) {
      const reason = `cannot stand beside "${there[0]}"; give exactly one of ${listed(group)}`;
      at.of(there[1]).fail(reason);
    }
    if (!there.length && table.one.includes(group)) {
      at.fail(`gives none of ${listed(group, "and")}; exactly one is needed`);
    }
  }
  for (const [key, other] of Object.entries(table.needs)) {
    if (node.value.has(key) && !node.value.has(other)) {
      at.of(key).fail(`stands alone; it belongs to "${other}", give "${other}" too`);
    }
  }
}

// The line of a key, or of the table that lacks it; null where there is none.
function lineOf(root, key) {
  let [node, line] = [root, null];
  for (const name of key.split(/[.[\]]+/).filter(Boolean)) {
    if (node.type === "table") node = node.value.get(name);
    else node = node.tables ? node.value[name] : undefined;
    if (!node) return line;
    line = node.line;
  }
  return line;
}

// Read and check a scene file; throws a SceneFault with key, reason and line.
function readScene(text) {
  const root = new TomlReader(text).read();
  try {
    return checkScene(root);
  } catch (fault) {
    if (fault instanceof SceneFault) fault.line ??= lineOf(root, fault.key);
    throw fault;
  }
}

function checkScene(root) {
  const bodies = root.value.get("body")?.value;
  const names = Array.isArray(bodies) ? bodies.map((each) => each.value?.get?.("name")?.value) : [];
  const top = new Place("", names.filter((name) => typeof name === "string" && name.includes(".")));
  for (const [name, reason] of Object.entries(LABORATORY_TABLES.gone)) {
    if (root.value.has(name)) top.of(name).fail(reason);
  }
  const seen = [];
  const scene = readTable(root, top, "Parts", seen);
  if (!scene.time) top.of("time").fail("is missing");
  for (const table of ["material", "body", "probe"]) checkNames(scene[table] ?? [], table, top);
  for (const found of seen) checkSeen(found, scene);
  if (!scene.body?.length) top.of("body").fail("there is no [[body]]; a scene needs at least one");
  for (const [key, reason] of conflicts(scene)) top.of(key).fail(reason);
  return scene;
}

function checkNames(tables, name, top) {
  const names = tables.map((table) => table.name);
  names.forEach((each, i) => {
    if (names.indexOf(each) === i) return;
    top.of(name).entry(i).of("name").fail(`"${each}" is used twice`);
  });
}

// A table with its own rules, a surface, or the name of another table.
function checkSeen({ at, model, value, table, name, face }, scene) {
  if (model) {
    for (const [key, reason] of refusals(model, value)) (key ? at.of(key) : at).fail(reason);
    return;
  }
  const known = (scene[table] ?? []).map((each) => each.name);
  if (face && known.includes(name) && !LABORATORY_TABLES.faces.includes(face)) {
    const near = suggestion(face, LABORATORY_TABLES.faces);
    at.fail(`"${name}.${face}": body "${name}" has no face "${face}"${near}`);
  }
  if (!known.includes(name)) at.fail(`no ${table} is named "${name}"${suggestion(name, known)}`);
}
