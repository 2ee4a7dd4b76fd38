// Controls of a laboratory: each has a name, a label, its allowed values and a value at the start. A list of numbers,
// which a picture changes, has a count and limits in place of a label, a text a greatest length.
"use strict";

let controlCount = 0;

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

// Text that begins a sentence.
function capital(text) {
  return text[0].toUpperCase() + text.slice(1);
}

// A number with three digits, and a power of ten where it is very small or large.
function digits(value) {
  const [part, power] = value.toExponential(2).split("e");
  if (value === 0 || Math.abs(power) < 4) return String(Number(value.toPrecision(3)));
  const raised = [...String(Number(power))].map((each) => (each === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[each]));
  return `${Number(part)}·10${raised.join("")}`;
}

// Text with the unit of a value.
function shown(declared, value) {
  return declared.unit ? `${value} ${declared.unit}` : String(value);
}

// One of some numbers, by a slider that moves over their places; `limit` shows only the first ones of them.
function slider(declared, value, changed) {
  const id = `laboratory-${controlCount++}`;
  const output = element("output", { for: id });
  const input = element("input", { id, type: "range", min: 0, max: declared.values.length - 1, step: 1 });
  const write = () => {
    const text = shown(declared, declared.values[input.value]) + (declared.counted ? ` of ${input.max}` : "");
    output.textContent = text;
    input.setAttribute("aria-valuetext", text);
  };
  const set = (next) => {
    input.value = declared.values.indexOf(next); // or the last place
    write();
  };
  input.addEventListener("input", () => {
    write();
    changed(declared.values[input.value]);
  });
  const limit = (most, next) => {
    input.max = most;
    set(next);
  };
  set(value);
  const label = element("label", { for: id }, element("span", {}, declared.label), output);
  return { box: element("div", { class: "laboratory-control" }, label, input), set, limit };
}

// One of some words.
function choice(declared, value, changed) {
  const id = `laboratory-${controlCount++}`;
  const options = Object.entries(declared.words).map(([name, text]) => {
    const option = element("option", { value: name });
    option.textContent = text;
    return option;
  });
  const select = element("select", { id }, ...options);
  select.value = value;
  select.addEventListener("change", () => changed(select.value));
  const set = (next) => (select.value = next);
  const label = element("label", { for: id }, declared.label);
  return { box: element("div", { class: "laboratory-control" }, label, select), set };
}

// The values of a state from a text such as "law=penalty&beta=10": what is not declared or not allowed is left out.
function readState(declarations, text) {
  const given = new URLSearchParams(text);
  const state = {};
  for (const declared of declarations) {
    const found = given.get(declared.name);
    state[declared.name] = declared.start;
    if (found === null) continue;
    if (declared.longest) {
      if (found.length <= declared.longest) state[declared.name] = found;
    } else if (declared.count) {
      const numbers = found.split(",").map(Number);
      const allowed = numbers.every((value) => value >= declared.least && value <= declared.most);
      if (numbers.length === declared.count && allowed) state[declared.name] = numbers;
    } else if (declared.words) {
      if (Object.hasOwn(declared.words, found)) state[declared.name] = found;
    } else if (declared.values.includes(Number(found))) {
      state[declared.name] = Number(found);
    }
  }
  return state;
}

// The inverse, without the values that a laboratory starts with.
function writeState(declarations, state) {
  const changed = declarations.filter(({ name, start }) => state[name] !== start);
  return changed.map(({ name }) => `${name}=${encodeURIComponent(state[name])}`).join("&");
}
