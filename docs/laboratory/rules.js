// Keys of a scene that are valid alone but contradict each other: the key and the reason, as in Python's model.
"use strict";

const NO_DIRECTION = "is zero, and must be a direction";

function belonging(model, value) {
  const { belongs, keys } = LABORATORY_TABLES.tables[model];
  const out = [];
  for (const [name, [other, wanted]] of Object.entries(belongs)) {
    const there = value[other] ?? keys[other].default;
    if (value[name] === undefined || value[name] === keys[name].default || there === wanted) continue;
    const given = typeof value[name] === "number" ? pythonNumber({ type: "float", value: value[name] }) : value[name];
    out.push([name, `is ${given}; it belongs to ${other} = "${wanted}", not to "${there}"`]);
  }
  return out;
}

function lawRules(model, value) {
  const out = belonging(model, value);
  if (value.tangent && !value.friction) out.push(["tangent", 'belongs to friction; give "friction" too']);
  if (value.initial_penetration === "remove") {
    out.push(["removal_time", 'is missing; initial_penetration = "remove" needs it']);
  }
  return out;
}

function radii({ radius: [inner, outer] }) {
  const why = `the outer radius must be above the inner one, ${shortNumber(inner)}`;
  return outer <= inner ? [["radius[1]", `is ${shortNumber(outer)}; ${why}`]] : [];
}

function direction(name, vector) {
  return vector.some((each) => each !== 0) ? [] : [[name, NO_DIRECTION]];
}

function turning({ axis }) {
  return axis && axis.every((each) => each === 0) ? [["axis", "is 0; it must have a direction"]] : [];
}

const RULES = {
  Spin: turning,
  Initial(value) {
    const why = "gives no displacement, gradient, angle, displacements or stress";
    return [...turning(value), ...(value.stress || displaces(value) ? [] : [["", why]])];
  },
  Damping: ({ rate, stiffness }) =>
    rate === undefined && stiffness === undefined
      ? [["", "gives none of rate, stiffness and relaxation; at least one is needed"]]
      : [],
  Ring: radii,
  Shell: radii,
  Plane: ({ normal }) => direction("normal", normal),
  "obstacle.Cylinder": ({ axis }) => direction("axis", axis),
  Body: ({ element, integration }) =>
    element === "hex20" && integration === "reduced"
      ? [["integration", '"reduced" with hourglass control is for hex8; hex20 is integrated in full']]
      : [],
  History({ time, value }) {
    const out = [];
    if (value.length !== time.length) {
      out.push(["value", `has ${value.length} entries, and time has ${time.length}; both need as many`]);
    }
    for (let i = 1; i < time.length; i++) {
      if (time[i] < time[i - 1]) {
        out.push([`time[${i}]`, `is ${shortNumber(time[i])}, before ${shortNumber(time[i - 1])}`]);
      }
    }
    return out;
  },
  Contact: (value) => lawRules("Contact", value),
  Obstacle(value) {
    const out = [];
    const moves = (value.travel ?? []).some((each) => each !== 0);
    if (moves !== Boolean(value.history)) {
      out.push(["history", 'and "travel" go together: the displacement is travel times the history']);
    }
    return [...out, ...lawRules("Obstacle", value)];
  },
  Load({ pressure = 0, traction = [], following }) {
    const pulls = traction.some((each) => each !== 0);
    if (pressure === 0 && !pulls) return [["", "gives neither a traction nor a pressure"]];
    const why = "is true, but only a pressure follows the surface, and there is none";
    return following && pressure === 0 ? [["following", why]] : [];
  },
  Support({ velocity = ZERO, fix }) {
    const out = [];
    velocity.forEach((value, i) => {
      if (value !== 0 && !fix.includes("xyz"[i])) {
        out.push([`velocity[${i}]`, `is ${shortNumber(value)}, but "${"xyz"[i]}" is not in fix`]);
      }
    });
    return out;
  },
  Probe({ name }) {
    const why = "has a slash or is a dot, and a results file can't have a table of this name";
    return name.includes("/") || name === "." ? [["name", `"${name}" ${why}`]] : [];
  },
};

function refusals(model, value) {
  return RULES[model]?.(value) ?? [];
}

// Tables that contradict each other.
function conflicts(scene) {
  return [...smallStrain(scene), ...samePair(scene), ...probing(scene), ...largeStrain(scene)];
}

function materialOf(scene, { material }) {
  return scene.material.find(({ name }) => name === material);
}

// Keys of bodies with large strain that are for small strain.
function smallStrain(scene) {
  const out = [];
  const { stiffness, bodies } = scene.damping ?? {};
  scene.body.forEach((body, i) => {
    const { name, law = "linear" } = materialOf(scene, body);
    if (law === "linear") return;
    const other = `material "${name}" has the law "${law}"`;
    if (body.integration === "reduced") out.push([`body[${i}].integration`, `"reduced" is for small strain; ${other}`]);
    if (body.initial?.stress) {
      out.push([`body[${i}].initial.stress`, `is for small strain; ${other}, so give the gradient that causes the stress`]);
    }
    if (stiffness && bodies?.includes(body.name) !== false) {
      const why = 'give a rate, or name other bodies in "bodies"';
      out.push(["damping.stiffness", `is for the law "linear", and "${body.name}" has "${law}"; ${why}`]);
    }
  });
  return out;
}

// Rotations of bodies whose strain is small.
function largeStrain(scene) {
  const out = [];
  scene.body.forEach((body, i) => {
    const { name, law = "linear" } = materialOf(scene, body);
    if (law !== "linear") return;
    const why = `turns the body, material "${name}" has the law "linear", with which a rotation causes false strain`;
    const turns = { spin: body.spin, "initial.angle": body.initial?.angle };
    for (const key of Object.keys(turns).filter((each) => turns[each])) {
      const large = WORDS.law.slice(1).map((each) => `"${each}"`).join(" or ");
      out.push([`body[${i}].${key}`, `${why}; give it the law ${large}, or make it [[rigid]]`]);
    }
  });
  return out;
}

function samePair({ contact = [] }) {
  const pairs = contact.map(({ surfaces }) => [...surfaces].sort().join(" "));
  const why = "its penalty would count twice (the order of the two surfaces makes no difference)";
  const twice = pairs.map((pair, i) => [pairs.indexOf(pair), i]).filter(([first, i]) => first < i);
  return twice.map(([first, i]) => [`contact[${i}].surfaces`, `is the pair of contact[${first}]; ${why}`]);
}

function probing(scene) {
  const out = [];
  (scene.probe ?? []).forEach(({ resultant, body }, i) => {
    if (resultant === undefined) return;
    const [, table, number] = /^(\w+?)(?:\[(\d+)\])?$/.exec(resultant);
    const count = scene[table]?.length ?? 0;
    const at = `probe[${i}].resultant`;
    if (Number(number ?? 0) >= count) {
      out.push([at, `the scene has ${count || "no"} [[${table}]]${count ? ", counted from 0" : ""}`]);
      return;
    }
    if (number === undefined && count > 1) {
      out.push([at, `"${table}" is one of ${count}; write "${table}[0]" ... "${table}[${count - 1}]"`]);
    }
    const given = scene[table][number ?? 0];
    const bodies = (given.surfaces ?? [given.surface]).map((name) => name.slice(0, name.lastIndexOf(".")));
    if (body !== undefined && !bodies.includes(body)) {
      out.push([`probe[${i}].body`, `"${table}" does not act on "${body}"${suggestion(body, bodies)}`]);
    }
  });
  return out;
}
