// TOML as scenes have it: tables, arrays of tables, dotted keys, texts, numbers, lists. A value is a node with its type
// and line; the value of a table is a Map of nodes, that of a list an array of nodes. Dates are no part of a scene.
"use strict";

class SceneFault extends Error {
  constructor(reason, key = "", line = null) {
    super((key ? `${key}: ` : "") + reason);
    Object.assign(this, { reason, key, line });
  }
}

const TOML_SPACE = /[ \t]*/y;
const TOML_GAP = /(?:[ \t\r\n]|#[^\n]*)*/y;
const TOML_BARE = /[A-Za-z0-9_-]+/y;
const TOML_NUMBER = /[+-]?(?:inf|nan|0x[0-9A-Fa-f_]+|0o[0-7_]+|0b[01_]+|[0-9][0-9_]*(?:\.[0-9][0-9_]*)?(?:[eE][+-]?[0-9_]+)?)/y;
const TOML_ESCAPES = { b: "\b", t: "\t", n: "\n", f: "\f", r: "\r", '"': '"', "\\": "\\" };

class TomlReader {
  constructor(text) {
    this.text = text;
    this.at = 0;
    this.root = this.node("table", new Map());
    this.root.line = 1;
  }

  get line() {
    return this.text.slice(0, this.at).split("\n").length;
  }

  node(type, value) {
    return { type, value, line: this.line };
  }

  fail(reason) {
    throw new SceneFault(`is not valid TOML: ${reason} (at line ${this.line})`, "", this.line);
  }

  // What a sticky pattern finds here, or null.
  take(pattern) {
    pattern.lastIndex = this.at;
    const found = pattern.exec(this.text);
    if (found) this.at += found[0].length;
    return found && found[0];
  }

  sees(word) {
    return this.text.startsWith(word, this.at);
  }

  skip(word) {
    if (!this.sees(word)) this.fail(`"${word}" is missing`);
    this.at += word.length;
  }

  read() {
    let table = this.root;
    for (;;) {
      this.take(TOML_GAP);
      if (this.at >= this.text.length) return this.root;
      if (this.sees("[")) table = this.header();
      else this.pair(table);
      this.take(TOML_SPACE);
      this.take(/#[^\n]*/y);
      if (this.at < this.text.length && !this.take(/\r?\n/y)) this.fail("something follows a value");
    }
  }

  keys() {
    const names = [];
    do {
      this.take(TOML_SPACE);
      if (this.sees('"') || this.sees("'")) names.push(this.string());
      else names.push(this.take(TOML_BARE) ?? this.fail("a key is missing"));
      this.take(TOML_SPACE);
    } while (this.take(/\./y));
    return names;
  }

  // The table of a header, in which the pairs that follow stand.
  header() {
    const many = this.sees("[[");
    this.skip(many ? "[[" : "[");
    const names = this.keys();
    const place = this.node("table", new Map());
    this.skip(many ? "]]" : "]");
    const last = names.pop();
    const outer = this.inner(this.root, names);
    const there = outer.value.get(last);
    if (many) {
      if (there && !there.tables) this.fail(`"${last}" is no array of tables`);
      if (!there) outer.value.set(last, { ...this.node("array", []), tables: true, line: place.line });
      outer.value.get(last).value.push(place);
      return place;
    }
    if (there && (there.type !== "table" || there.given)) this.fail(`"${last}" is given twice`);
    const table = there ?? place;
    table.given = true;
    outer.value.set(last, table);
    return table;
  }

  // The table at the end of some names, made where it is missing.
  inner(table, names) {
    for (const name of names) {
      let next = table.value.get(name);
      if (!next) table.value.set(name, (next = this.node("table", new Map())));
      if (next.tables) next = next.value[next.value.length - 1];
      if (next.type !== "table" || next.closed) this.fail(`"${name}" is no table that can be continued`);
      table = next;
    }
    return table;
  }

  pair(table) {
    const { line } = this;
    const names = this.keys();
    const last = names.pop();
    const outer = this.inner(table, names);
    this.skip("=");
    if (outer.value.has(last)) this.fail(`"${last}" is given twice`);
    const value = this.value();
    outer.value.set(last, { ...value, line });
  }

  value() {
    this.take(TOML_SPACE);
    if (this.sees('"') || this.sees("'")) return this.node("string", this.string());
    if (this.sees("[")) return this.list();
    if (this.sees("{")) return this.inlineTable();
    const flag = this.take(/true|false/y);
    if (flag) return this.node("boolean", flag === "true");
    const text = this.take(TOML_NUMBER);
    if (!text || /[\w.:-]/.test(this.text[this.at] ?? "")) this.fail("no value that a scene can have");
    return this.number(text.replaceAll("_", ""));
  }

  number(text) {
    const special = text.replace("inf", "Infinity").replace("nan", "NaN");
    if (/^[+-]?\d+$/.test(text)) return { ...this.node("integer", Number(text)), text: BigInt(text).toString() };
    if (/^0[xob]/.test(text)) return { ...this.node("integer", Number(text)), text: String(Number(text)) };
    return this.node("float", Number(special));
  }

  list() {
    const out = this.node("array", []);
    this.skip("[");
    for (;;) {
      this.take(TOML_GAP);
      if (this.take(/\]/y)) return out;
      out.value.push(this.value());
      this.take(TOML_GAP);
      if (!this.take(/,/y)) {
        this.skip("]");
        return out;
      }
    }
  }

  inlineTable() {
    const out = { ...this.node("table", new Map()), given: true };
    this.skip("{");
    this.take(TOML_SPACE);
    while (!this.sees("}")) {
      this.pair(out);
      this.take(TOML_SPACE);
      if (!this.take(/,/y)) break;
      this.take(TOML_SPACE);
    }
    this.skip("}");
    out.closed = true;
    return out;
  }

  string() {
    const mark = this.take(/"""|'''|"|'/y);
    const whole = mark.length === 3;
    if (whole) this.take(/\r?\n/y);
    let out = "";
    while (!this.sees(mark)) {
      const letter = this.text[this.at++];
      if (letter === undefined || (letter === "\n" && !whole)) this.fail("a text has no end");
      out += letter === "\\" && mark[0] === '"' ? this.escaped() : letter;
    }
    this.at += mark.length;
    return out;
  }

  escaped() {
    const letter = this.text[this.at++];
    const code = letter === "u" ? this.take(/[0-9A-Fa-f]{4}/y) : letter === "U" ? this.take(/[0-9A-Fa-f]{8}/y) : null;
    if (code) return String.fromCodePoint(parseInt(code, 16));
    return TOML_ESCAPES[letter] ?? this.fail("an unknown escape in a text");
  }
}
