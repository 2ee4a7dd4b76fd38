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
