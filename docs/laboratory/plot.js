// Curves over an axis, drawn on a canvas with the colours of the page.
"use strict";

const COLOURS = { blue: "#3b8bd4", orange: "#e8762b", green: "#3fa34d", red: "#d64550", violet: "#9b6fd0", grey: "#8a8a8a" };
const PLOT_MARGIN = { left: 58, right: 24, top: 22, bottom: 40 };

// The letters of a picture, three quarters of those of the page; `ratio` is that of its pixels.
function plotFont(ratio = 1) {
  const size = parseFloat(getComputedStyle(document.documentElement).fontSize);
  return `${0.75 * size * ratio}px system-ui, sans-serif`;
}

// Round numbers between two limits, about `count` of them.
function ticksOf(low, high, count) {
  const raw = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) ticks.push(i * step);
  return ticks;
}

function tickText(value) {
  const text = Number(value.toPrecision(6));
  return Math.abs(text) >= 1e5 || (text !== 0 && Math.abs(text) < 1e-3) ? digits(text) : String(text);
}

// Smallest and largest finite number of some lists, with a margin; `must` has to be inside.
function rangeOf(lists, must = []) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of [...lists, must]) {
    for (const value of list) {
      if (!Number.isFinite(value)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  if (low > high) return [0, 1];
  const margin = 0.05 * (high - low) || 1;
  return [low - margin, high + margin];
}

// A canvas of the width of its column and its pen in pixels of the page, of which each has `ratio` of the screen;
// null while it is not shown.
function penOf(canvas, height) {
  const width = canvas.clientWidth;
  if (width === 0) return null;
  const ratio = devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  return { pen, width, height, ratio };
}

class Plot {
  constructor({ x, y, height = 180, label }) {
    this.names = { x, y };
    this.height = height;
    this.canvas = element("canvas", { role: "img", "aria-label": label, class: "laboratory-plot" });
    this.canvas.style.height = `${height}px`;
    this.shown = null;
    new ResizeObserver(() => this.shown && this.draw(...this.shown)).observe(this.canvas);
  }

  // Curves { x, y, colour, name, dash, points }, and limits [low, high] of the axes.
  draw(curves, limits) {
    this.shown = [curves, limits];
    const on = penOf(this.canvas, this.height);
    if (!on) return;
    const { pen, width } = on;
    pen.font = plotFont();
    const box = {
      left: PLOT_MARGIN.left, top: PLOT_MARGIN.top,
      width: width - PLOT_MARGIN.left - PLOT_MARGIN.right,
      height: this.height - PLOT_MARGIN.top - PLOT_MARGIN.bottom,
    };
    const place = {
      x: (value) => box.left + ((value - limits.x[0]) / (limits.x[1] - limits.x[0])) * box.width,
      y: (value) => box.top + box.height - ((value - limits.y[0]) / (limits.y[1] - limits.y[0])) * box.height,
    };
    this.drawAxes(pen, box, place, limits);
    pen.save();
    pen.beginPath();
    pen.rect(box.left, box.top, box.width, box.height);
    pen.clip();
    for (const curve of curves) this.drawCurve(pen, place, curve);
    pen.restore();
    this.drawNames(pen, box, curves);
  }

  drawAxes(pen, box, place, limits) {
    const text = getComputedStyle(this.canvas).color;
    pen.fillStyle = text;
    pen.lineWidth = 1;
    pen.strokeStyle = "rgb(136 136 136 / 30%)";
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const value of ticksOf(...limits.x, Math.max(2, box.width / 80))) {
      const at = place.x(value);
      stroke(pen, [[at, box.top], [at, box.top + box.height]]);
      pen.fillText(tickText(value), at, box.top + box.height + 4);
    }
    pen.fillText(this.names.x, box.left + box.width / 2, box.top + box.height + 20);
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const value of ticksOf(...limits.y, Math.max(2, box.height / 40))) {
      const at = place.y(value);
      stroke(pen, [[box.left, at], [box.left + box.width, at]]);
      pen.fillText(tickText(value), box.left - 5, at);
    }
    pen.save();
    pen.translate(10, box.top + box.height / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(this.names.y, 0, 0);
    pen.restore();
  }

  drawCurve(pen, place, { x, y, colour, dash = [], points = false, width = 1.6 }) {
    const own = COLOURS[colour] ?? getComputedStyle(this.canvas).color;
    pen.strokeStyle = pen.fillStyle = own;
    pen.lineWidth = width;
    pen.setLineDash(dash);
    pen.beginPath();
    for (let i = 0; i < x.length; i++) {
      if (points) {
        pen.moveTo(place.x(x[i]) + width + 1, place.y(y[i]));
        pen.arc(place.x(x[i]), place.y(y[i]), width + 1, 0, 7);
      } else {
        pen.lineTo(place.x(x[i]), place.y(y[i]));
      }
    }
    if (points) pen.fill();
    else pen.stroke();
    pen.setLineDash([]);
  }

  // Names of the curves in a row above them.
  drawNames(pen, box, curves) {
    pen.textAlign = "left";
    pen.textBaseline = "top";
    let left = box.left;
    for (const { name, colour } of curves) {
      if (!name) continue;
      pen.fillStyle = COLOURS[colour] ?? getComputedStyle(this.canvas).color;
      pen.fillText(name, left, 3);
      left += pen.measureText(name).width + 16;
    }
  }
}

function stroke(pen, line) {
  pen.beginPath();
  line.forEach(([x, y]) => pen.lineTo(x, y));
  pen.stroke();
}
