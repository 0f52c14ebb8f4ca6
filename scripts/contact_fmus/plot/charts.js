// Lines over time with a cursor in step, drawn on two canvases: the lines, redrawn when the range changes, and the
// cursor above them. Used by the plot's page and by the animation's.

/** Doubles from base64. */
function decodeNumbers(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float64Array(bytes.buffer);
}

/** Index of the last of the rising times that is not after t; 0 before the first. */
function rowBefore(times, t) {
  let low = 0;
  let high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** Where t lies on the way from a row to the next one, from 0 to 1. An event of Model Exchange has two rows at one time. */
function shareOf(times, row, t) {
  const step = times[row + 1] - times[row];
  return step > 0 ? Math.min(1, Math.max(0, (t - times[row]) / step)) : 1;
}

/** A value between the rows by a straight line. */
function valueAt(times, values, t) {
  const row = Math.min(rowBefore(times, t), times.length - 2);
  const share = shareOf(times, row, t);
  return values[row] + share * (values[row + 1] - values[row]);
}

/** Four digits, without an exponent where it can be read without. */
function shortNumber(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(2) : Number(value.toPrecision(4)).toString();
  return text.replace("e+", "e").replace("-", "−");
}

/** Seconds with a prefix and `digits` digits behind the point of the unit that `span` is read in. */
function timeText(t, span) {
  const [factor, unit] = span >= 1 ? [1, "s"] : span >= 1e-3 ? [1e3, "ms"] : span >= 1e-6 ? [1e6, "µs"] : [1e9, "ns"];
  return `${(t * factor).toFixed(span * factor >= 100 ? 2 : 3)} ${unit}`;
}

/** A tick's value with as many digits as tell it from the other ticks. */
function tickText(value, ticks) {
  const step = ticks.length > 1 ? ticks[1] - ticks[0] : Math.abs(value) || 1;
  const place = Math.floor(Math.log10(step) + 1e-9);
  const size = Math.abs(value);
  if (size < 1e-9 * step) return "0";
  const digits = Math.min(15, Math.max(0, Math.floor(Math.log10(size) + 1e-9) - place));
  const text = size >= 1e5 || size < 1e-3 ? value.toExponential(digits) : value.toFixed(Math.min(15, Math.max(0, -place)));
  return text.replace("e+", "e").replaceAll("-", "−");
}

/** Round numbers from low to high, about `count` of them. */
function niceTicks(low, high, count) {
  const rough = (high - low) / count;
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= rough);
  const ticks = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) ticks.push(k * step);
  return ticks;
}

const LEAST_SPAN = 1e-6; // of what an axis shows: less is rounding, and is drawn as what stays the same
const DASHES = [[], [6, 3], [2, 3], [8, 3, 2, 3]];
const MARGIN = { left: 58, right: 12, top: 8, bottom: 24 };

class Chart {
  /** `group` is told of what the pointer does: {pick(t), range(a, b), reset()}. */
  constructor(parent, chart, times, touches, group) {
    this.times = times;
    this.touches = touches;
    this.linear = chart.linear;
    this.lines = chart.lines.map((line) => ({ ...line, values: decodeNumbers(line.values) }));
    this.range = [times[0][0], times[0][times[0].length - 1]];
    this.cursor = null;
    this.build(parent, chart);
    this.listen(group);
  }

  build(parent, chart) {
    const figure = document.createElement("figure");
    figure.className = "chart";
    const caption = document.createElement("figcaption");
    caption.innerHTML = "<b></b><span class=legend></span>";
    caption.querySelector("b").textContent = chart.unit ? `${chart.title} [${chart.unit}]` : chart.title;
    this.readouts = this.lines.map((line) => {
      const entry = document.createElement("span");
      entry.innerHTML = "<i></i><span></span> <output></output>";
      entry.querySelector("i").style.cssText = `border-top:2px ${line.dash % 4 || line.sum ? "dashed" : "solid"} ${lineColor(line)}`;
      entry.querySelector("span").textContent = line.label;
      caption.querySelector(".legend").append(entry);
      return entry.querySelector("output");
    });
    this.plot = document.createElement("div");
    this.plot.className = "plot";
    this.base = document.createElement("canvas");
    this.over = document.createElement("canvas");
    this.plot.append(this.base, this.over);
    figure.append(caption, this.plot);
    parent.append(figure);
    new ResizeObserver(() => this.resize()).observe(this.plot);
  }

  resize() {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.width = this.plot.clientWidth;
    this.height = this.plot.clientHeight;
    for (const canvas of [this.base, this.over]) {
      canvas.width = Math.round(this.width * ratio);
      canvas.height = Math.round(this.height * ratio);
      canvas.getContext("2d").setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    this.draw();
  }

  /** Time to pixels. */
  x(t) {
    const [begin, end] = this.range;
    return MARGIN.left + ((t - begin) / (end - begin)) * (this.width - MARGIN.left - MARGIN.right);
  }

  t(x) {
    const [begin, end] = this.range;
    const share = (x - MARGIN.left) / (this.width - MARGIN.left - MARGIN.right);
    return begin + Math.min(1, Math.max(0, share)) * (end - begin);
  }

  /** Linear up to `linear`, logarithmic beyond: penetrations stay visible next to flights. */
  bend(value) {
    if (!this.bent || Math.abs(value) <= this.linear) return this.bent ? value / this.linear : value;
    return Math.sign(value) * (1 + Math.log10(Math.abs(value) / this.linear));
  }

  unbend(height) {
    if (!this.bent || Math.abs(height) <= 1) return this.bent ? height * this.linear : height;
    return Math.sign(height) * this.linear * 10 ** (Math.abs(height) - 1);
  }

  y(value) {
    const [low, high] = this.limits;
    return this.height - MARGIN.bottom - ((this.bend(value) - low) / (high - low)) * (this.height - MARGIN.top - MARGIN.bottom);
  }

  /** The heights of what is in range, with some air. */
  findLimits() {
    let low = Infinity;
    let high = -Infinity;
    for (const line of this.lines) {
      const times = this.times[line.run];
      const last = Math.min(times.length - 1, rowBefore(times, this.range[1]) + 1);
      for (let row = rowBefore(times, this.range[0]); row <= last; row++) {
        const value = line.values[row];
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    if (!(low <= high)) [low, high] = [0, 1];
    this.bent = this.linear !== null && high > 10 * this.linear;
    [low, high] = [this.bend(low), this.bend(high)];
    const size = Math.max(Math.abs(low), Math.abs(high));
    const air = high - low > LEAST_SPAN * size ? 0.06 * (high - low) : 0.5 * size || 1;
    this.limits = [low - air, high + air];
  }

  ticks() {
    const [low, high] = this.limits;
    if (!this.bent) return niceTicks(low, high, 6);
    const powers = [0];
    for (let k = 0; k + 1 <= high; k++) powers.push(this.linear * 10 ** k);
    return low < -1 ? [-this.linear, ...powers] : powers;
  }

  draw() {
    if (!this.width || !this.height) return;
    const pen = this.base.getContext("2d");
    pen.clearRect(0, 0, this.width, this.height);
    this.findLimits();
    this.drawFrame(pen);
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, MARGIN.top, this.width - MARGIN.left - MARGIN.right, this.height - MARGIN.top - MARGIN.bottom);
    pen.clip();
    this.drawTouches(pen);
    for (const line of this.lines) this.drawLine(pen, line);
    pen.restore();
    this.drawCursor();
  }

  drawFrame(pen) {
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = themeColor("--muted");
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    const ticks = this.ticks();
    for (const value of ticks) {
      const y = this.y(value);
      pen.strokeStyle = themeColor(value === 0 ? "--axis" : "--grid");
      pen.beginPath();
      pen.moveTo(MARGIN.left, y);
      pen.lineTo(this.width - MARGIN.right, y);
      pen.stroke();
      pen.fillText(this.bent ? shortNumber(value) : tickText(value, ticks), MARGIN.left - 6, y);
    }
    this.drawTimes(pen);
  }

  /** Times since the range's begin where the range is too narrow for their digits. */
  drawTimes(pen) {
    const [begin, end] = this.range;
    const span = end - begin;
    const relative = span < 1e-3 * Math.max(Math.abs(begin), Math.abs(end));
    const [factor, unit] = span >= 1 ? [1, "s"] : span >= 1e-3 ? [1e3, "ms"] : span >= 1e-6 ? [1e6, "µs"] : [1e9, "ns"];
    const origin = relative ? begin : 0;
    pen.textAlign = "center";
    pen.textBaseline = "top";
    const ticks = niceTicks((begin - origin) * factor, (end - origin) * factor, Math.max(2, this.width / 75));
    for (const tick of ticks) {
      const x = this.x(origin + tick / factor);
      if (x > this.width - MARGIN.right - 34) continue; // there stands the unit
      pen.fillText(tickText(tick, ticks), x, this.height - MARGIN.bottom + 6);
    }
    pen.textAlign = "right";
    pen.fillText(relative ? `after ${begin.toPrecision(6)} s [${unit}]` : `[${unit}]`, this.width - MARGIN.right + 6, this.height - MARGIN.bottom + 6);
  }

  drawTouches(pen) {
    pen.fillStyle = themeColor("--touch");
    pen.beginPath(); // filled at once: where contacts overlap the shade is no darker
    for (const [begin, end] of this.touches) {
      const [left, right] = [this.x(begin), this.x(end)];
      if (right < 0 || left > this.width) continue;
      pen.rect(left, MARGIN.top, Math.max(1, right - left), this.height - MARGIN.top - MARGIN.bottom);
    }
    pen.fill();
  }

  drawLine(pen, line) {
    const times = this.times[line.run];
    const last = Math.min(times.length - 1, rowBefore(times, this.range[1]) + 1);
    pen.strokeStyle = lineColor(line);
    pen.setLineDash(DASHES[line.sum ? 1 : line.dash % DASHES.length]);
    pen.lineWidth = 1.6;
    pen.lineJoin = "round";
    pen.beginPath();
    let down = false;
    for (let row = rowBefore(times, this.range[0]); row <= last; row++) {
      const value = line.values[row];
      if (Number.isNaN(value)) {
        down = false;
        continue;
      }
      pen[down ? "lineTo" : "moveTo"](this.x(times[row]), this.y(value));
      down = true;
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  setRange(begin, end) {
    this.range = [begin, end];
    this.draw();
  }

  setCursor(t) {
    this.cursor = t;
    this.drawCursor();
  }

  drawCursor() {
    if (!this.width || !this.limits) return;
    const pen = this.over.getContext("2d");
    pen.clearRect(0, 0, this.width, this.height);
    this.lines.forEach((line, index) => {
      const told = this.cursor === null ? "" : shortNumber(valueAt(this.times[line.run], line.values, this.cursor));
      if (this.readouts[index].value !== told) this.readouts[index].value = told;
    });
    if (this.cursor === null || this.cursor < this.range[0] || this.cursor > this.range[1]) return;
    const x = this.x(this.cursor);
    pen.strokeStyle = themeColor("--text");
    pen.beginPath();
    pen.moveTo(x, MARGIN.top);
    pen.lineTo(x, this.height - MARGIN.bottom);
    pen.stroke();
    for (const line of this.lines) {
      const y = this.y(valueAt(this.times[line.run], line.values, this.cursor));
      if (!Number.isFinite(y)) continue;
      pen.fillStyle = lineColor(line);
      pen.beginPath();
      pen.arc(x, y, 3.2, 0, 2 * Math.PI);
      pen.fill();
    }
  }

  /** A press picks a time, the wheel zooms about it, a double click shows all. */
  listen(group) {
    const place = (event) => this.t(event.clientX - this.over.getBoundingClientRect().left);
    let pressed = false;
    this.over.addEventListener("pointerdown", (event) => {
      pressed = true;
      this.over.setPointerCapture(event.pointerId);
      group.pick(place(event));
    });
    this.over.addEventListener("pointermove", (event) => {
      if (pressed || (group.hovers && event.pointerType === "mouse")) group.pick(place(event));
    });
    for (const kind of ["pointerup", "pointercancel"]) this.over.addEventListener(kind, () => (pressed = false));
    this.over.addEventListener("dblclick", () => group.reset());
    this.over.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey && !event.shiftKey && !group.hovers) return; // else the page would not scroll
        event.preventDefault();
        const middle = place(event);
        const factor = Math.exp(0.002 * (event.deltaY || event.deltaX));
        group.range(middle + (this.range[0] - middle) * factor, middle + (this.range[1] - middle) * factor);
      },
      { passive: false },
    );
  }
}

const COLORS = 10; // --color-0 ... of the style
let themeCache = new Map();

function themeColor(name) {
  if (!themeCache.has(name)) themeCache.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  return themeCache.get(name);
}

function colorOf(index) {
  return themeColor(`--color-${index % COLORS}`);
}

/** What is the sum of other lines has the colour of text. */
function lineColor(line) {
  return line.sum ? themeColor("--text") : colorOf(line.color);
}

/** All charts of a page, which share range and cursor. */
class Charts {
  constructor(parent, data, options) {
    const times = data.times.map(decodeNumbers);
    this.whole = [times[0][0], times[0][times[0].length - 1]];
    const group = {
      hovers: options.hovers,
      pick: options.pick,
      reset: () => this.setRange(...this.whole),
      range: (begin, end) => this.setRange(begin, end),
    };
    this.all = data.charts.map((chart) => new Chart(parent, chart, times, data.touches, group));
    const scheme = window.matchMedia("(prefers-color-scheme: dark)");
    scheme.addEventListener("change", () => this.restyle());
  }

  restyle() {
    themeCache = new Map();
    for (const chart of this.all) {
      chart.readouts.forEach((output, index) => (output.parentElement.querySelector("i").style.borderTopColor = lineColor(chart.lines[index])));
      chart.draw();
    }
  }

  setRange(begin, end) {
    const least = 64 * 2 ** -52 * Math.max(Math.abs(begin), Math.abs(end));
    if (!(end - begin > least)) return;
    for (const chart of this.all) chart.setRange(Math.max(begin, this.whole[0]), Math.min(end, this.whole[1]));
  }

  setCursor(t) {
    for (const chart of this.all) chart.setCursor(t);
  }
}
