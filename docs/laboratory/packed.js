// Files that stand beside the page as scripts, so that a page from a disk can read them without a server.
"use strict";

const laboratoryFiles = new Map();

// Called by such a script: gzip, as base64.
function laboratoryFile(name, text) {
  laboratoryFiles.set(name, text);
}

async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Put a file together that was stored as its differences from another one (tools/build_page.py).
function unpackDifferences(stored, old) {
  let at = 0;
  const number = () => {
    let value = 0;
    for (let scale = 1; ; scale *= 128) {
      const byte = stored[at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value;
    }
  };
  const parts = [];
  while (at < stored.length) {
    const own = number();
    parts.push(stored.subarray(at, at + own));
    at += own;
    const place = number();
    parts.push(old.subarray(place, place + number()));
  }
  const out = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let length = 0;
  for (const part of parts) {
    out.set(part, length);
    length += part.length;
  }
  return out;
}

// The module for this browser; `read` gives a file by its name.
async function moduleBytes(read, simd) {
  const own = await unpack(await read("module-simd"));
  return simd ? own : unpackDifferences(await unpack(await read("module-plain")), own);
}
