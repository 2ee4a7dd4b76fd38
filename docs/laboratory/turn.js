// A view from a direction that the pointer and the keys turn, without perspective.
"use strict";

const TURN_STEP = Math.PI / 24;

class Turn {
  constructor(azimuth, elevation) {
    this.azimuth = azimuth;
    this.elevation = elevation;
  }

  // Axes of the picture in space: to the right, up, towards the reader.
  get axes() {
    const [sa, ca] = [Math.sin(this.azimuth), Math.cos(this.azimuth)];
    const [se, ce] = [Math.sin(this.elevation), Math.cos(this.elevation)];
    return [[-sa, ca, 0], [-ca * se, -sa * se, ce], [ca * ce, sa * ce, se]];
  }

  by(right, up) {
    this.azimuth -= right;
    this.elevation = Math.max(-1.55, Math.min(1.55, this.elevation + up));
  }

  // Turn by a key; whether the key is one of those.
  key(name) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[name];
    if (step) this.by(step[0] * TURN_STEP, step[1] * TURN_STEP);
    return Boolean(step);
  }
}

// Follow a pointer that is pressed on a canvas: `begin(place)`, then `move(place, change)`; places in pixels of the page.
// A finger that moves up or down scrolls the page, unless `begin` says that it holds something.
function followPointer(canvas, begin, move) {
  let last = null;
  let held = false;
  const placeOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.style.touchAction = "pan-y";
  canvas.addEventListener("touchstart", (event) => held && event.preventDefault(), { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    last = placeOf(event);
    held = begin(last);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!last) return;
    const place = placeOf(event);
    move(place, [place[0] - last[0], place[1] - last[1]]);
    last = place;
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => (last = null));
}
