// All laboratories of the page.
"use strict";

function startLaboratories() {
  for (const box of document.querySelectorAll("[data-laboratory]")) {
    const name = box.dataset.laboratory;
    if (Object.hasOwn(LABORATORIES, name)) box.laboratory = new Laboratory(box, name);
  }
}

if (document.readyState === "loading") addEventListener("DOMContentLoaded", startLaboratories);
else startLaboratories();
