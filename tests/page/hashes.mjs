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
for (const name of ["laboratory.js", "module-simd.js", "module-plain.js"]) {
  vm.runInContext(await readFile(`${folder}/${name}`, "utf8"), context, { filename: name });
}
let input = "";
for await (const part of process.stdin) input += part;
context.kind = kind;
context.tasks = input;
const answer = await vm.runInContext(`(async () => {
  const library = await Library.open(await moduleBytes((name) => laboratoryFiles.get(name), kind === "simd"));
  const all = (pointer, count) => library.doubles(pointer, count);
  const answers = {
    run({ scene }) {
      buildScene(library, scene);
      library.check(library.call.advance(library.call.step_count()));
      return hashOf(all(library.call.displacement(), 3 * library.call.node_count(-1)));
    },
    project({ nodes, points }) {
      library.give(nodes.flat());
      library.call.set_face(nodes.length === 8 ? 1 : 0);
      library.give(points.flat());
      library.check(library.call.project_all(points.length));
      return hashOf(all(library.call.numbers(1), 3 * points.length));
    },
    simplex({ nodes, point, start }) {
      library.give(nodes.flat());
      library.call.set_face(1);
      const found = projected(library, point, CLOSEST.simplex, start).path;
      const rolled = rollSimplex(library, point, start).map(({ corners, low }) => corners[low]);
      return { found, rolled: rolled.slice(1) };
    },
    check({ text }) {
      try {
        return { scene: readScene(text) };
      } catch (fault) {
        if (!(fault instanceof SceneFault)) throw fault;
        return { key: fault.key, reason: fault.reason, line: fault.line };
      }
    },
    exact({ rows, poisson }) {
      library.give(rows.flat());
      library.check(library.call.exact_plates(rows.length, poisson));
      return [...all(library.call.numbers(1), 5 * rows.length)];
    },
  };
  return JSON.stringify(JSON.parse(tasks).map((task) => answers[task.task](task)));
})()`, context);
console.log(answer);
