// What the module of the pages computes, in Node: `hashes.mjs FOLDER simd|plain` reads tasks as JSON from its input.
import { readFile } from "node:fs/promises";
import vm from "node:vm";

const [folder, kind] = process.argv.slice(2);
const context = vm.createContext({
  WebAssembly, TextDecoder, TextEncoder, Uint8Array, Float64Array, Int32Array, Blob, Response, DecompressionStream, atob, performance,
  // A page without laboratories.
  document: { currentScript: { src: "" }, readyState: "complete", querySelectorAll: () => [] },
});
context.globalThis = context;
const scripts = ["laboratory.js", "module-simd.js", "module-plain.js"].map((name) => `${folder}/${name}`);
for (const script of [...scripts, new URL("tasks.js", import.meta.url)]) {
  vm.runInContext(await readFile(script, "utf8"), context, { filename: String(script) });
}
let input = "";
for await (const part of process.stdin) input += part;
Object.assign(context, { kind, tasks: input });
console.log(await vm.runInContext("answersOf(kind, JSON.parse(tasks)).then(JSON.stringify)", context));
