// Order of what a search finds: chapters and the glossary before members of structs, unless the query is a name of the
// code, which has an underscore.
var Scorer = {
  score: ([page, title, anchor, description, score, file, kind]) => {
    const query = new URLSearchParams(window.location.search).get("q") ?? "";
    if (query.includes("_")) return score;
    if (/^(week|theory|reference[/]glossary)/.test(page)) return score + 40;
    if (/^(start|tutorials|benchmarks|stability)/.test(page)) return score + 20;
    return score;
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: {0: 15, 1: 5, 2: -5},
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
