// The library in WebAssembly: calls, arrays and errors. Runs in a worker of a page and in Node.
"use strict";

class LibraryError extends Error {}

class Library {
  static async open(bytes) {
    const library = new Library();
    const { instance } = await WebAssembly.instantiate(bytes, {});
    instance.exports._initialize();
    library.call = instance.exports;
    return library;
  }

  // A text of C.
  text(pointer) {
    const memory = new Uint8Array(this.call.memory.buffer);
    return new TextDecoder().decode(memory.subarray(pointer, memory.indexOf(0, pointer)));
  }

  // Throw an error with the text of the library unless a call succeeded.
  check(status) {
    if (status !== 0) throw new LibraryError(this.text(this.call.error_text()));
  }

  // The array through which numbers go in and come out; a call that allocates may move it.
  numbers(count) {
    const pointer = this.call.numbers(count);
    if (pointer === 0) throw new LibraryError("out of memory");
    return new Float64Array(this.call.memory.buffer, pointer, count);
  }

  // A copy of an array of C.
  doubles(pointer, count) {
    if (pointer === 0) throw new LibraryError(this.text(this.call.error_text()) || "out of memory");
    return new Float64Array(this.call.memory.buffer, pointer, count).slice();
  }

  integers(pointer, count) {
    return new Int32Array(this.call.memory.buffer, pointer, count).slice();
  }

  give(values) {
    this.numbers(values.length).set(values);
  }
}

// The hash of an array's bytes (FNV-1a), as the C programs that compare machines compute it.
function hashOf(values) {
  const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
  const prime = 1099511628211n;
  let hash = 14695981039346656037n;
  for (const byte of bytes) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * prime);
  return hash.toString(16).padStart(16, "0");
}
