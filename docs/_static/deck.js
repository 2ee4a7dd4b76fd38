// Keys of a presentation: forwards and backwards by one slide. What answers a question "Predict" is covered until the first key or a click.
const STEPS = {ArrowRight: 1, ArrowDown: 1, PageDown: 1, " ": 1, ArrowLeft: -1, ArrowUp: -1, PageUp: -1};
const COVERED = "section.predict > :is(figure, .literal-block-wrapper, [class^='highlight-'])";

addEventListener("keydown", event => {
  const step = event.shiftKey || event.ctrlKey || event.altKey ? 0 : STEPS[event.key] ?? 0;
  if (!step) return;
  event.preventDefault();
  const slides = [...document.querySelectorAll("main > section")];
  const distance = slide => Math.abs(slide.getBoundingClientRect().top);
  const shown = slides.reduce((best, slide, i) => (distance(slide) < distance(slides[best]) ? i : best), 0);
  if (step > 0 && slides[shown].matches(".predict:not(.told)")) slides[shown].classList.add("told");
  else slides[Math.min(Math.max(shown + step, 0), slides.length - 1)].scrollIntoView();
});

addEventListener("click", event => event.target.closest(COVERED)?.parentElement.classList.add("told"));

// On a wide screen a listing takes the largest letters with which its slide fits the window.
const SIZES = ["1rem", "0.9rem", "0.8rem", "0.7rem"];

const fit = () => {
  for (const slide of document.querySelectorAll("main > section:has(pre)")) {
    const listings = [...slide.querySelectorAll("pre")];
    const set = size => listings.forEach(listing => { listing.style.fontSize = size; });
    const fits = size => {
      set(size);
      return slide.scrollHeight <= innerHeight + 1 && listings.every(listing => listing.scrollWidth <= listing.clientWidth);
    };
    if (!matchMedia("(min-width: 63em)").matches || !SIZES.some(fits)) set("");
  }
};

addEventListener("load", async () => {
  await globalThis.MathJax?.startup?.promise;
  fit();
  addEventListener("resize", fit);
  addEventListener("afterprint", fit);
});

// A sheet of paper is a little smaller than the window may be.
addEventListener("beforeprint", () => {
  for (const listing of document.querySelectorAll("main > section pre")) listing.style.fontSize = "";
});
