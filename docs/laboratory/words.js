// The words of the messages of a scene, as Python's reader has them (schema.py).
"use strict";

// A number as Python writes it.
function pythonNumber(node) {
  if (node.type === "integer") return node.text;
  const { value } = node;
  if (Number.isNaN(value)) return "nan";
  if (!Number.isFinite(value)) return value < 0 ? "-inf" : "inf";
  if (value === 0) return Object.is(value, -0) ? "-0.0" : "0.0";
  const [digits, power] = value.toExponential().split("e");
  const exponent = Number(power);
  if (exponent < -4 || exponent >= 16) {
    return `${digits}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
  }
  const text = Math.abs(exponent) < 7 || exponent > 0 ? String(value) : value.toFixed(20).replace(/0+$/, "");
  return text.includes(".") ? text : `${text}.0`;
}

// A number as Python's format "g" writes it.
function shortNumber(value) {
  if (value === 0) return "0";
  const [digits, power] = value.toExponential(5).split("e");
  const exponent = Number(power);
  const trim = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  if (exponent >= -4 && exponent < 6) return trim(value.toFixed(5 - exponent));
  return `${trim(digits)}e${exponent < 0 ? "-" : "+"}${String(Math.abs(exponent)).padStart(2, "0")}`;
}

// A text as Python's repr writes it.
function pythonText(text) {
  const quote = text.includes("'") && !text.includes('"') ? '"' : "'";
  const escaped = text.replaceAll("\\", "\\\\").replaceAll("\n", "\\n").replaceAll("\t", "\\t");
  return quote + (quote === "'" ? escaped.replaceAll("'", "\\'") : escaped) + quote;
}

function describe(node) {
  const { type, value } = node;
  if (type === "boolean") return `the boolean ${value}`;
  if (type === "string") return value.length <= 60 ? `the text "${value}"` : `a text of ${value.length} characters`;
  if (type === "table") return "a table";
  if (type === "array") return `a list of ${value.length}`;
  const text = pythonNumber(node);
  return text.length <= 60 ? text : `a ${type === "integer" ? "int" : "float"}`;
}

// "x", "y" or "z".
function listed(words, last = "or") {
  const quoted = words.map((each) => `"${each}"`);
  const end = quoted.pop();
  return quoted.length ? `${quoted.join(", ")} ${last} ${end}` : end;
}

// Number of letters in the matching blocks of two texts (Ratcliff and Obershelp), as Python's difflib finds them.
function matching(a, b) {
  let [best, i0, j0] = [0, 0, 0];
  for (let i = 0; i < a.length; i++) {
    for (let j = 0; j < b.length; j++) {
      let n = 0;
      while (i + n < a.length && j + n < b.length && a[i + n] === b[j + n]) n++;
      if (n > best) [best, i0, j0] = [n, i, j];
    }
  }
  if (best === 0) return 0;
  return best + matching(a.slice(0, i0), b.slice(0, j0)) + matching(a.slice(i0 + best), b.slice(j0 + best));
}

// The known name that is most like a text, if it is like enough.
function nearestName(text, known, cutoff) {
  let best = null;
  for (const name of known) {
    const ratio = (2 * matching(name, text)) / (name.length + text.length || 1);
    if (ratio < cutoff) continue;
    if (!best || ratio > best.ratio || (ratio === best.ratio && name > best.name)) best = { ratio, name };
  }
  return best && best.name;
}

function suggestion(text, known, lead = "known: ") {
  const names = new Map(known.map((name) => [name.toLowerCase(), name]));
  const near = nearestName(text.toLowerCase(), [...names.keys()], 0.6);
  if (near !== null) return `; did you mean "${names.get(near)}"?`;
  return known.length ? `; ${lead}${listed(known)}` : "; there is none";
}
