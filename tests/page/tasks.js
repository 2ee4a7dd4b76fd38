// Tasks of the tests, answered by the module of the pages: in Node (hashes.mjs) and in the page of a browser.
"use strict";

async function answersOf(tasks) {
  const library = await Library.open(await unpack(await packedFile("module")));
  const all = (pointer, count) => library.doubles(pointer, count);
  const answers = {
    end({ scene }) {
      buildScene(library, scene);
      library.check(library.call.advance(library.call.step_count()));
      return [...all(library.call.displacement(), 3 * library.call.node_count(-1))];
    },
    run: (task) => hashOf(Float64Array.from(answers.end(task))),
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
  return tasks.map((task) => answers[task.task](task));
}
