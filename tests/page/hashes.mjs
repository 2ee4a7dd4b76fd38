// What the module of the pages computes, in Node: `hashes.mjs FOLDER` reads tasks as JSON from its input.
import { readFile } from "node:fs/promises";
import vm from "node:vm";

const folder = process.argv[2];
const context = vm.createContext({
  WebAssembly, TextDecoder, TextEncoder, Uint8Array, Float64Array, Int32Array, Blob, Response, DecompressionStream, atob, performance,
  // A page without laboratories.
  document: { currentScript: { src: "" }, readyState: "complete", querySelectorAll: () => [] },
});
context.globalThis = context;
for (const script of [`${folder}/laboratory.js`, `${folder}/module.js`, new URL("tasks.js", import.meta.url)]) {
  vm.runInContext(await readFile(script, "utf8"), context, { filename: String(script) });
}
let input = "";
for await (const part of process.stdin) input += part;
context.tasks = input;
console.log(await vm.runInContext("answersOf(JSON.parse(tasks)).then(JSON.stringify)", context));
