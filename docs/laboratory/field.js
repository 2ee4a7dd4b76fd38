// Two square fields of values side by side, mirrored at the plane of contact, in colours from blue to red.
"use strict";

// Colour of a value from -1 to 1: blue, pale, red.
function colourOf(value) {
  const at = Math.max(-1, Math.min(1, value));
  const ends = at < 0 ? [59, 76, 192] : [180, 4, 38];
  const weight = Math.abs(at);
  return ends.map((end) => Math.round(221 + weight * (end - 221)));
}

class Field {
  constructor(label) {
    this.canvas = element("canvas", { role: "img", "aria-label": label, class: "laboratory-plot" });
    this.shown = null;
    new ResizeObserver(() => {
      this.canvas.style.height = `${this.height}px`;
      if (this.shown) this.draw(...this.shown);
    }).observe(this.canvas);
  }

  // Two squares, and below them the scale of colours and its name.
  get height() {
    return Math.round(this.canvas.clientWidth / 2) + 50;
  }

  // Fields of the left and right body, n by n; the largest value of the colours; lines of the right one, in its size.
  draw(fields, n, largest, lines, name) {
    this.shown = [fields, n, largest, lines, name];
    const on = penOf(this.canvas, this.height);
    if (!on) return;
    const { pen, ratio } = on;
    pen.resetTransform(); // to pixels of the screen
    const size = this.canvas.width / 2;
    pen.imageSmoothingEnabled = false;
    fields.forEach((field, body) => pen.drawImage(this.image(field, n, largest), body * size, 0, size, size));
    pen.strokeStyle = "#101010";
    pen.lineWidth = 1.2 * ratio;
    for (const side of [-1, 1]) {
      for (const line of lines) stroke(pen, line.map(([x, z]) => [size * (1 + side * x), size * (1 - z)]));
    }
    this.drawScale(pen, size, ratio, largest, name);
  }

  image(field, n, largest) {
    const canvas = new OffscreenCanvas(n, n);
    const pen = canvas.getContext("2d");
    const image = pen.createImageData(n, n);
    for (let k = 0; k < n; k++) {
      for (let i = 0; i < n; i++) {
        image.data.set([...colourOf(field[i + n * k] / largest), 255], 4 * (i + n * (n - 1 - k)));
      }
    }
    pen.putImageData(image, 0, 0);
    return canvas;
  }

  drawScale(pen, size, ratio, largest, name) {
    const top = size + 8 * ratio;
    for (let i = 0; i < 100; i++) {
      pen.fillStyle = `rgb(${colourOf(i / 49.5 - 1)})`;
      pen.fillRect(size * (0.5 + i / 100), top, size / 100 + 1, 8 * ratio);
    }
    pen.fillStyle = getComputedStyle(this.canvas).color;
    pen.font = plotFont(ratio);
    pen.textBaseline = "top";
    pen.textAlign = "center";
    [-largest, 0, largest].forEach((value, i) => pen.fillText(String(value), size * (0.5 + i / 2), top + 10 * ratio));
    pen.fillText(name, size, top + 26 * ratio);
    ["left plate", "right plate"].forEach((text, i) => pen.fillText(text, size * (0.2 + 1.6 * i), top));
  }
}
