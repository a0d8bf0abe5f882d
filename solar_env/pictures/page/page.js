"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const slider = document.getElementById("time"), clock = document.getElementById("clock");
const INK = "#1d2733", QUIET = "#66717f", BODY = "#7c8896";
// Of journals in contact, as in frames, and apart: no joint has these colours.
const FORCE = "#e01e37", JOURNAL = "#8e99a6", SMALL = "21px sans-serif";
const colour = (k) => data.colours[k % data.colours.length];

// Index of the last of ascending times that is not after t.
function indexAt(times, t) {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle; else high = middle - 1;
  }
  return low;
}

// Array on the left, magnified bearings on the right.
class MotionView {
  constructor(motion) {
    this.motion = motion;
    const box = document.createElement("div");
    box.className = "motion";
    box.innerHTML = "<strong></strong>";
    box.firstChild.textContent = motion.name;
    this.canvas = document.createElement("canvas");
    this.canvas.width = 1200;
    this.canvas.height = 560;
    box.append(this.canvas);
    document.getElementById("motions").append(box);
    let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity;
    for (const rows of [motion.body, ...motion.panels]) for (const row of rows) for (let i = 0; i < row.length; i += 2) {
      x0 = Math.min(x0, row[i]); x1 = Math.max(x1, row[i]);
      y0 = Math.min(y0, row[i + 1]); y1 = Math.max(y1, row[i + 1]);
    }
    this.scale = Math.min(730 / (x1 - x0), 500 / (y1 - y0));
    this.place = (x, y) => [30 + (x - x0) * this.scale, 530 - (y - y0) * this.scale];
  }
  trace(pen, row) {
    pen.beginPath();
    for (let i = 0; i < row.length; i += 2) pen.lineTo(...this.place(row[i], row[i + 1]));
  }
  draw(t) {
    const m = this.motion, k = indexAt(m.time, t), pen = this.canvas.getContext("2d");
    pen.clearRect(0, 0, 1200, 560);
    this.trace(pen, m.body[k]);
    pen.closePath();
    pen.fillStyle = BODY;
    pen.fill();
    pen.lineWidth = 7;
    pen.lineCap = "round";
    m.panels.forEach((rows, j) => { pen.strokeStyle = "#0072b2"; this.trace(pen, rows[k]); pen.stroke(); });
    m.panels.forEach((rows, j) => {
      const [x, y] = this.place(rows[k][0], rows[k][1]);
      pen.fillStyle = colour(j); pen.beginPath(); pen.arc(x, y, 8, 0, 7); pen.fill();
    });
    pen.fillStyle = QUIET;
    pen.font = "20px sans-serif";
    pen.textAlign = "left";
    if (m.torque.flat().some((x) => x !== 0)) pen.fillText(`motor ${m.torque[k].map((x) => x.toFixed(3)).join(", ")} N m`, 30, 28);
    const shown = Math.min(m.panels.length, 3), radius = Math.min(100, 240 / shown);
    for (let j = 0; j < shown; j++) this.bearing(pen, j, k, t, 870, (560 * (j + 0.5)) / shown, radius);
  }
  // The drawn gap stands for the clearance: circles touch exactly where the surfaces do.
  bearing(pen, j, k, t, x, y, radius) {
    const m = this.motion, journal = 0.72 * radius, force = m.force[k][j], [ex, ey] = m.eccentricity[k][j];
    const clearance = 1e3 * m.clearance[j], touching = force > 0 && clearance > 0;
    pen.lineWidth = 5;
    pen.strokeStyle = colour(j);
    pen.beginPath(); pen.arc(x, y, radius, 0, 7); pen.stroke();
    pen.fillStyle = touching ? FORCE : JOURNAL;
    pen.beginPath(); pen.arc(x + ex * (radius - journal), y - ey * (radius - journal), journal - 2.5, 0, 7); pen.fill();
    // The colour of the third line is that of the journal, which it explains.
    const lines = [[`joint ${j + 1}`, colour(j), SMALL], [`${force.toPrecision(3)} N`, INK, "bold 28px sans-serif"]];
    if (clearance > 0) {
      lines.push([touching ? "in contact" : "apart", touching ? FORCE : JOURNAL, SMALL]);
      lines.push([`clearance ${clearance < 1 ? clearance.toPrecision(2) : clearance.toFixed(1)} mm`, QUIET, SMALL]);
    } else lines.push(["ideal joint", QUIET, SMALL]);
    lines.push([m.latch_times[j] !== null && t >= m.latch_times[j] ? "latched" : "not latched", QUIET, SMALL]);
    pen.textAlign = "left";
    lines.forEach(([text, ink, font], i) => {
      pen.fillStyle = ink;
      pen.font = font;
      pen.fillText(text, x + radius + 14, y - 48 + 29 * i);
    });
  }
}

// A title in lines that fit a width; letters of 15 pixels are less than 9 wide.
function wrapped(title, width) {
  const lines = [""];
  for (const word of title.split(" ")) {
    const last = lines[lines.length - 1];
    if (last && 9 * (last.length + word.length + 1) > width) lines.push(word);
    else lines[lines.length - 1] = last ? `${last} ${word}` : word;
  }
  return lines.join("<br>");
}

// Least and greatest exponent of what a logarithmic axis shows.
function decades(lines, name) {
  let low = Infinity, high = -Infinity;
  for (const line of lines) for (const value of line[name]) if (value > 0) {
    low = Math.min(low, Math.log10(value)); high = Math.max(high, Math.log10(value));
  }
  return low < high ? [low, high] : [0, 1];
}
// A label at each decade of a wide axis, and several within those of a narrow one.
const logTicks = ([low, high]) => high - low > 2.2 ? Math.min(Math.floor(high - low) + 1, 8) : 4;

// A radial axis in the direction [deg] where its labels hide least: between those that have a name, where curves are shallowest.
function radialAxis(lines, unit) {
  const deepest = (wanted) => Math.max(0, ...lines.map((line) => Math.max(0, ...line.y.filter((_, i) => wanted(line.x[i])))));
  const near = (direction) => deepest((angle) => Math.abs((angle - direction + 540) % 360 - 180) < 20);
  const angle = [22.5, -22.5, 67.5, -67.5, 112.5, -112.5, 157.5, -157.5].reduce((best, next) => near(next) < near(best) ? next : best);
  const most = deepest(() => true) || 1, power = 10 ** Math.floor(Math.log10(most / 2));
  const step = [5, 2, 1].find((factor) => factor * power <= most / 2) * power, values = [];
  for (let value = step; value <= 1.01 * most; value += step) values.push(value);
  return { angle, tickangle: angle, range: [0, 1.05 * most], tickvals: values, ticktext: values.map((value) => `${+value.toPrecision(3)} ${unit}`) };
}

// A vertical axis with names, the first on top.
const named = (bars) => ({ tickvals: bars.map((_, k) => k), ticktext: bars, range: [bars.length - 0.4, -0.6] });

class ChartView {
  constructor(chart) {
    this.chart = chart;
    this.box = document.createElement("div");
    this.box.className = "chart";
    this.plot = document.createElement("div");
    this.cursor = document.createElement("div");
    this.cursor.className = "cursor";
    this.box.append(this.plot, this.cursor);
    document.getElementById("charts").append(this.box);
  }
  // After all boxes have their places, for the width.
  plotLines() {
    const chart = this.chart;
    const traces = chart.lines.map((line) => {
      const look = { mode: "lines", line: chart.bars.length ? { color: line.colour, width: line.dash === "solid" ? 12 : 4 } : { color: line.colour, dash: line.dash, width: 1.4 } };
      return chart.polar ? { type: "scatterpolar", name: line.name, theta: line.x, r: line.y, ...look }
        : { type: "scatter", name: line.name, x: line.x, y: line.y, ...look };
    });
    const axis = (title, name, limits) => {
      const log = chart.logarithmic.includes(name), ends = limits && log ? limits.map(Math.log10) : limits;
      return { title: { text: title }, type: log ? "log" : "linear", gridcolor: "#e6e9ed", zeroline: false, automargin: true,
        ...(ends ? { range: ends } : {}), ...(log ? { tickformat: "~g", nticks: logTicks(ends || decades(chart.lines, name)) } : {}) };
    };
    const width = this.plot.clientWidth, title = wrapped(chart.title, width), above = 18 * (title.split("<br>").length - (chart.polar ? 0 : 1));
    const below = 18 * Math.ceil(traces.length / Math.max(1, Math.floor(width / 180)));
    const layout = { title: { text: title, font: { size: 15 }, x: 0.01 }, height: 320 + above + below, margin: { t: 40 + above, r: 12, b: 60 + below, l: 60 },
      legend: { orientation: "h", yref: "container", y: 0, yanchor: "bottom" }, hovermode: "closest", font: { color: INK },
      xaxis: axis(chart.x, "x"), yaxis: { ...axis(chart.y, "y", chart.limits), ...(chart.bars.length ? named(chart.bars) : {}) },
      ...(chart.polar ? { polar: { radialaxis: radialAxis(chart.lines, chart.y) } } : {}) };
    Plotly.newPlot(this.plot, traces, layout, { responsive: true, displayModeBar: false });
    if (chart.over_time) {
      this.plot.on("plotly_click", (event) => show(event.points[0].x));
      this.plot.on("plotly_relayout", (change) => this.share(change));
    }
  }
  // Zooming one chart over time zooms the others.
  share(change) {
    if (!("xaxis.range[0]" in change || "xaxis.autorange" in change)) return;
    const range = [change["xaxis.range[0]"], change["xaxis.range[1]"]];
    const wanted = range[0] === undefined ? { "xaxis.autorange": true } : { "xaxis.range": range };
    for (const other of charts) if (other !== this && other.chart.over_time) Plotly.relayout(other.plot, wanted);
    show(now);
  }
  draw(t) {
    if (!this.chart.over_time) return;
    const { xaxis, yaxis } = this.plot._fullLayout, x = xaxis.l2p(t), style = this.cursor.style;
    style.display = x >= 0 && x <= xaxis._length ? "block" : "none";
    style.left = `${this.plot.offsetLeft + xaxis._offset + x}px`;
    style.top = `${this.plot.offsetTop + yaxis._offset}px`;
    style.height = `${yaxis._length}px`;
  }
}

let now = 0, playing = null;
const motions = data.motions.map((motion) => new MotionView(motion));
const charts = data.charts.map((chart) => new ChartView(chart));
for (const view of charts) view.plotLines();
const end = Math.max(0, ...data.motions.map((motion) => motion.time[motion.time.length - 1]));
slider.min = 0;
slider.max = end;

function show(t) {
  now = Math.min(Math.max(Number(t), 0), end);
  slider.value = now;
  clock.textContent = `${now.toFixed(3)} s`;
  for (const view of [...motions, ...charts]) view.draw(now);
}
slider.addEventListener("input", () => show(slider.value));
document.getElementById("play").addEventListener("click", (event) => {
  if (playing) { cancelAnimationFrame(playing); playing = null; event.target.textContent = "play"; return; }
  event.target.textContent = "pause";
  if (now >= end) now = 0;
  let before = null;
  const step = (stamp) => {
    if (before !== null) show(now + 1e-3 * (stamp - before) * Number(document.getElementById("speed").value));
    before = stamp;
    if (now < end) { playing = requestAnimationFrame(step); return; }
    playing = null;
    event.target.textContent = "play";
  };
  playing = requestAnimationFrame(step);
});
window.addEventListener("resize", () => show(now));
// page.html#t=12.5 opens at that time, and else at the first latching.
const first = Math.min(...data.motions.flatMap((motion) => motion.latch_times.filter((t) => t !== null)));
const asked = /^#t=([\d.]+)$/.exec(location.hash);
show(asked ? asked[1] : isFinite(first) ? first : 0);
