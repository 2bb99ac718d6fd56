// SPDX-License-Identifier: Apache-2.0
"use strict";
// Draws the plots, with plotly.js. Colours come from the style sheet, so that light and dark share their code.

const PALETTE = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00"];  // Okabe and Ito
const PLOT_OPTIONS = { responsive: true, displaylogo: false, displayModeBar: "hover",
  modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d", "hoverClosestCartesian", "hoverCompareCartesian"] };

const MOST_DRAWN_ALONE = 3000;  // more points of the Pareto plot are a cloud behind it

let places = null;  // of all points in the Pareto plot, with the scales of its axes

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

function axisLayout(title, more = {}) {
  return { title: { text: escaped(title), font: { size: 12.5 }, standoff: 8 }, gridcolor: colour("line"),
    zerolinecolor: colour("line"), linecolor: colour("soft"), ticks: "outside", tickcolor: colour("line"),
    automargin: true, ...more };
}

function layoutOf(height, more = {}) {
  return { height, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", hovermode: "closest", dragmode: "zoom",
    font: { family: getComputedStyle(document.body).fontFamily, size: 12, color: colour("text") },
    margin: { l: 60, r: 16, t: 12, b: 46 }, hoverlabel: { align: "left", bgcolor: colour("panel"),
      bordercolor: colour("line"), font: { color: colour("text"), size: 12 } },
    modebar: { bgcolor: "rgba(0,0,0,0)", color: colour("soft"), activecolor: colour("accent") },
    legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0, font: { size: 12 } }, ...more };
}

// Returns the least and the greatest value. A call of Math.min with 100,000 arguments would fail.
function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const v of values) { low = Math.min(low, v); high = Math.max(high, v); }
  return [low, high];
}

// Returns where zeros go on a logarithmic axis: half a decade below the smallest positive value. Returns null where a
// linear axis is better. The rule is that of log_floor in analysis.py.
function logFloor(values) {
  const finite = values.filter(Number.isFinite);
  const positive = finite.filter((v) => v > 0);
  if (!positive.length || finite.some((v) => v < 0)) return null;
  const [low, high] = extent(positive);
  if (high / low < 4 || (high / low < 8 && positive.length === finite.length)) return null;
  return low / Math.sqrt(10);
}

// Returns an axis for values: {place(value), layout, shape}. Zeros of a logarithmic axis stand at its foot, on a marked
// line.
function scaleFor(values, title, letter) {
  const floor = logFloor(values);
  if (floor === null) return { place: (v) => v, layout: axisLayout(title), shapes: [], annotations: [], log: false };
  const zero = values.includes(0);
  const across = letter === "y" ? { xref: "paper", x0: 0, x1: 1, yref: "y", y0: floor, y1: floor }
    : { yref: "paper", y0: 0, y1: 1, xref: "x", x0: floor, x1: floor };
  const label = letter === "y" ? { xref: "paper", x: 0, xanchor: "right", yref: "y", y: Math.log10(floor), xshift: -4 }
    : { yref: "paper", y: 0, yanchor: "top", xref: "x", x: Math.log10(floor), yshift: -4 };
  return { place: (v) => (v === 0 ? floor : v), log: true,
    layout: axisLayout(title, { type: "log", exponentformat: "e", minexponent: 4, dtick: decadesApart(values) }),
    shapes: zero ? [{ type: "line", layer: "below", line: { color: colour("soft"), width: 1, dash: "dot" }, ...across }] : [],
    annotations: zero ? [{ text: "0", showarrow: false, font: { color: colour("soft") }, ...label }] : [] };
}

// Returns ticks at decades, or sparser ones over a long range. Below two decades they stand at 1, 2, 5 of each.
function decadesApart(values) {
  const positive = values.filter((v) => v > 0 && Number.isFinite(v));
  const [low, high] = extent(positive), decades = Math.log10(high / low);
  return decades < 2 ? "D2" : Math.max(1, Math.round(decades / 7));
}

const limitsOf = (metric) => data.limits.filter((l) => l.metric === metric).flatMap((l) => l.limits);

// Returns a dashed line across the plot for each limit of what an axis shows.
function limitShapes(limits, scale, letter) {
  const across = (l) => (letter === "y" ? { xref: "paper", x0: 0, x1: 1, yref: "y", y0: l, y1: l }
    : { yref: "paper", y0: 0, y1: 1, xref: "x", x0: l, x1: l });
  return limits.filter((l) => !scale.log || l > 0).map((l) => ({ type: "line", ...across(l),
    line: { color: colour("alarm"), width: 1.3, dash: "dash" } }));
}

// Draws a plot in which a click on a point that names its index (customdata) shows that point, or what `choose` makes of it.
function drawPlot(element, traces, layout, choose = (index) => index) {
  Plotly.react(element, traces, layout, PLOT_OPTIONS);
  if (element.dataset.listening) return;
  element.dataset.listening = "yes";
  element.on("plotly_click", (event) => {
    const hit = event.points.find((p) => Number.isInteger(p.customdata));
    if (hit) showPoint(choose(hit.customdata));
  });
}

function hoverOf(index, x, y) {
  const all = settingsOf(index), settings = all.slice(0, 12).map(([k, v]) => `${escaped(k)} = ${escaped(v)}`);
  const scene = sceneAt(y, index);
  const lines = [`<b>${escaped(y)}</b> ${textOf(metricAt(y, index))} ${escaped(data.units[y] || "")}${scene && ` on ${escaped(scene)}`}`,
    `<b>${escaped(x)}</b> ${textOf(metricAt(x, index))} ${escaped(data.units[x] || "")}`, ...settings];
  if (all.length > 12) lines.push("…");
  if (holdsAt(index) === false) lines.push("fails a constraint");
  const others = pointsAtPlace(index).length - 1;
  if (others > 0) lines.push(`and ${others} more at this place`);
  return lines.join("<br>");
}

function drawPareto() {
  const element = byId("pareto-plot");
  if (!element) return;
  const { x, y } = shown;
  const costs = columnOf(x), errors = columnOf(y), front = frontOf(x, y);
  const xScale = scaleFor(costs, titleOf(x), "x"), yScale = scaleFor(errors, titleOf(y), "y");
  places = { x: costs.map(xScale.place), y: errors.map(yScale.place) };
  const drawable = [];
  for (let i = 0; i < data.count; ++i) if (Number.isFinite(costs[i]) && Number.isFinite(errors[i])) drawable.push(i);
  const special = new Set([...data.recommended, data.base]);
  const trace = (name, indices, marker, more = {}) => ({ name, type: "scatter", mode: "markers", marker,
    x: indices.map((i) => places.x[i]), y: indices.map((i) => places.y[i]), customdata: indices,
    text: indices.map((i) => hoverOf(i, x, y)), hovertemplate: "%{text}<extra></extra>", ...more });
  const onFront = new Set(front);
  const plain = drawable.filter((i) => !special.has(i) && !onFront.has(i));
  const failing = plain.filter((i) => holdsAt(i) === false), others = plain.filter((i) => holdsAt(i) !== false);
  const many = plain.length > MOST_DRAWN_ALONE;
  const cloudTrace = (name, indices, marker) => (many && indices.length ? entryTrace(name, marker)
    : trace(name, indices, marker));
  const traces = [
    cloudTrace("fails a constraint", failing,
      { symbol: "x-thin-open", size: 6, color: colour("fail"), line: { color: colour("fail"), width: 1.2 } }),
    cloudTrace("point", others, { size: 6, color: colour("point"), opacity: 0.8 }),
    trace("Pareto front", front, { size: 7, color: colour("accent") },
      { mode: "lines+markers", line: { shape: "hv", width: 2, color: colour("accent") } }),
    trace("base", drawable.filter((i) => i === data.base),
      { symbol: "diamond-open", size: 13, color: colour("text"), line: { width: 2 } }),
    trace("recommended", drawable.filter((i) => data.recommended.includes(i)),
      { symbol: "star", size: 16, color: colour("warm"), line: { width: 1, color: colour("text") } }),
    ...(many ? [cornersTrace(plain)] : []),
  ].filter((t) => t.x.length);
  const layout = layoutOf(540, { xaxis: xScale.layout, yaxis: yScale.layout,
    shapes: [...limitShapes(limitsOf(y), yScale, "y"), ...xScale.shapes, ...yScale.shapes],
    annotations: [...xScale.annotations, ...yScale.annotations] });
  drawPlot(element, [...traces, markTrace()], layout, nextOfPlace);
  setCloud(element, !many ? null : { ...places, hover: (i) => hoverOf(i, x, y), choose: nextOfPlace, groups: [
    { name: "fails a constraint", indices: failing, colour: colour("fail"), cross: true },
    { name: "point", indices: others, colour: colour("point"), cross: false }] });
  markPoint();
}

// Returns what is drawn of points that are in a cloud: their entry in the legend.
function entryTrace(name, marker) {
  return { name, type: "scatter", mode: "markers", x: [null], y: [null], hoverinfo: "skip", marker };
}

// Returns an invisible trace with the corners of the box around the points, so that the axes show them all.
function cornersTrace(indices) {
  return { type: "scatter", mode: "markers", x: extent(indices.map((i) => places.x[i])), y: extent(indices.map((i) => places.y[i])),
    hoverinfo: "skip", showlegend: false, marker: { size: 6, opacity: 0 } };
}

// Returns the points that the Pareto plot draws at the same place as this one: the noted ones, then those of the front.
function pointsAtPlace(index) {
  const { x, y } = shown, costs = columnOf(x), errors = columnOf(y), same = [];
  const is = (a, b) => a === b || (Number.isNaN(a) && Number.isNaN(b));
  for (let i = 0; i < data.count; ++i) if (is(costs[i], costs[index]) && is(errors[i], errors[index])) same.push(i);
  const front = frontOf(x, y);
  const rank = (i) => [data.recommended.includes(i), i === data.base, front.includes(i), true].indexOf(true);
  return same.sort((a, b) => rank(a) - rank(b) || a - b);
}

// A click shows the first point of the place, and a further click shows the next.
function nextOfPlace(index) {
  const same = pointsAtPlace(index);
  return same.includes(shown.point) ? same[(same.indexOf(shown.point) + 1) % same.length] : same[0];
}

// The ring around the shown point is always the last trace.
function markTrace() {
  return { name: "shown", type: "scatter", mode: "markers", x: [], y: [], hoverinfo: "skip", showlegend: false,
    marker: { symbol: "circle-open", size: 20, color: colour("alarm"), line: { width: 2 } } };
}

function markPoint() {
  const element = byId("pareto-plot");
  if (!element || !element.data || shown.point === null) return;
  const x = places.x[shown.point], y = places.y[shown.point], visible = Number.isFinite(x) && Number.isFinite(y);
  Plotly.restyle(element, { x: [visible ? [x] : []], y: [visible ? [y] : []] }, [element.data.length - 1]);
}

function drawWidths() {
  const box = byId("widths-plots");
  if (!box) return;
  const metric = byId("widths-y").value;
  data.curves[metric].forEach((curve, number) => {
    if (!box.children[number]) box.append(make("div", {}, make("h3"), make("div", { className: "chart" })));
    const [heading, element] = box.children[number].children;
    const axis = data.axes[number];
    const samples = curve.samples.filter((s) => Number.isFinite(toNumber(s[1])));
    const kind = curve.oneAtATime ? "one at a time" : "best of all";
    const knee = curve.knee === null ? (axis.numeric ? "no knee" : "") : `knee at ${curve.samples[curve.knee][0]}`;
    heading.replaceChildren(axis.label, make("span", { className: "note", textContent: `${kind}${knee && ", " + knee}` }));
    heading.title = axis.keys.join(", ");
    box.children[number].className = !axis.numeric && samples.length > 8 ? "wide" : "";
    drawCurve(element, metric, axis, samples, curve.knee === null ? null : curve.samples[curve.knee]);
  });
}

function drawCurve(element, metric, axis, samples, knee) {
  const scale = scaleFor(samples.map((s) => s[1]), titleOf(metric), "y");
  const place = (value) => (axis.numeric ? value : escaped(value));
  const traces = [{ type: "scatter", mode: axis.numeric ? "lines+markers" : "markers", x: samples.map((s) => place(s[0])),
    y: samples.map((s) => scale.place(s[1])), customdata: samples.map((s) => s[2]), line: { color: colour("accent"), width: 2 },
    marker: { size: 7, color: colour("accent") }, text: samples.map((s) => `${escaped(axis.shown)}: ${escaped(s[0])}<br>` +
      `${escaped(metric)} ${textOf(s[1])}`), hovertemplate: "%{text}<extra></extra>" }];
  if (knee) {
    traces.push({ type: "scatter", mode: "markers", x: [place(knee[0])], y: [scale.place(knee[1])], hoverinfo: "skip",
      marker: { symbol: "circle-open", size: 17, color: colour("alarm"), line: { width: 2.5 } } });
  }
  const numbers = axis.numeric ? samples.map((s) => s[0]) : [];
  const whole = numbers.every(Number.isInteger) && Math.max(...numbers) - Math.min(...numbers) <= 14 ? { dtick: 1 } : {};
  const decades = Math.min(...numbers) > 0 && Math.max(...numbers) >= 100 * Math.min(...numbers);
  const spread = decades ? { type: "log", exponentformat: "e", minexponent: 4, dtick: 1 } : whole;
  drawPlot(element, traces, layoutOf(element.closest(".wide") ? 340 : 260, { showlegend: false, yaxis: scale.layout,
    xaxis: axisLayout(axis.numeric ? axis.shown : "", axis.numeric ? spread : { type: "category" }),
    shapes: [...limitShapes(limitsOf(metric), scale, "y"), ...scale.shapes], annotations: scale.annotations }));
}

function drawSearch() {
  const element = byId("search-plot");
  if (!element) return;
  const steps = (holds) => data.steps.filter((s) => s[2] === holds && Number.isFinite(toNumber(s[1])));
  const trace = (name, some, marker) => ({ name, type: "scatter", mode: "markers", marker, x: some.map((s) => s[0]),
    y: some.map((s) => s[1]), customdata: some.map((s) => s[3]),
    hovertemplate: `evaluation %{x}<br>cost %{y}<extra>${name}</extra>` });
  drawPlot(element, [
    trace("fails a constraint", steps(false),
      { symbol: "x-thin-open", size: 6, color: colour("fail"), line: { color: colour("fail"), width: 1.2 } }),
    trace("holds", steps(true), { size: 6, color: colour("point") }),
    { name: "lowest that holds", type: "scatter", mode: "lines", line: { shape: "hv", width: 2, color: colour("accent") },
      x: data.best.map((b) => b[0]), y: data.best.map((b) => b[1]), hoverinfo: "skip" },
  ].filter((t) => t.x.length), layoutOf(340, { xaxis: axisLayout("evaluation"), yaxis: axisLayout(data.costTitle) }));
}

// Draws the plots of the blocks that are visible and not drawn yet.
function drawVariants() {
  const drawers = { unseen: drawUnseen, registers: drawRegisters, budget: drawBudget, bounds: drawBounds };
  for (const element of document.querySelectorAll("[data-plot]")) {
    if (element.closest("[hidden]") || element.dataset.drawn) continue;
    element.dataset.drawn = "yes";
    drawers[element.dataset.plot](element, data[element.dataset.plot][element.dataset.hash]);
  }
}

// Draws the share of views with at most a value. An element shows one constraint.
function drawUnseen(element, panels) {
  const { title, limits, count, views } = panels[element.dataset.part];
  const values = views.map((v) => v[1]), scale = scaleFor([...values, ...limits], title, "x");
  const x = values.map(scale.place), y = views.map((_, i) => 100 * (i + 1) / count);
  const marks = (name, holds, marker) => {
    const at = views.flatMap((v, i) => (v[2] === holds ? [i] : []));
    return { name, type: "scatter", mode: "markers", marker, x: at.map((i) => x[i]), y: at.map((i) => y[i]),
      text: at.map((i) => `<b>${escaped(views[i][0])}</b> ${textOf(values[i])}: ${name}`), hovertemplate: "%{text}<extra></extra>" };
  };
  drawPlot(element, [
    { type: "scatter", mode: "lines", line: { shape: "hv", width: 2, color: colour("accent") }, x: x.length ? [x[0], ...x] : [],
      y: [0, ...y], hoverinfo: "skip", showlegend: false },
    marks("holds", true, { size: 7, color: colour("accent") }),
    marks("fails", false, { symbol: "x-thin-open", size: 8, color: colour("alarm"), line: { color: colour("alarm"), width: 2 } }),
  ].filter((t) => t.x.length), layoutOf(280, { xaxis: scale.layout, annotations: scale.annotations,
    yaxis: axisLayout("views with at most this [%]", { range: [0, 105] }),
    shapes: [...limitShapes(limits, scale, "x"), ...scale.shapes] }));
}

function drawRegisters(element, registers) {
  const row = (i) => registers.length - 1 - i;
  const bars = { name: "values (height: logarithm of the count)", type: "bar", orientation: "v", x: [], y: [], base: [], text: [], width: 1,
    marker: { color: [], line: { width: 0 } }, hovertemplate: "%{text}<extra></extra>", textposition: "none" };
  const band = (name, fill, pattern) => ({ name, type: "bar", orientation: "h", x: [], y: [], base: [], width: 0.92,
    marker: { color: fill, line: { width: 0 }, ...pattern }, text: [], hovertemplate: "%{text}<extra></extra>", textposition: "none" });
  const range = band("range of the format", colour("range"), {});
  const spare = band("unused head-room", colour("spare"),
    { pattern: { shape: "/", fgcolor: colour("warm"), bgcolor: colour("spare"), size: 6, solidity: 0.2 } });
  registers.forEach((r, i) => {
    const about = `<b>${escaped(r.name)}</b> ${escaped(r.format)}<br>min ${textOf(toNumber(r.min))}, max ${textOf(toNumber(r.max))}` +
      `<br>${r.count} values, ${r.zeros} zeros<br>head-room ${r.headroom} bits, ${r.wraps} wraps, ${r.saturations} saturations`;
    const add = (trace, from, to) => {
      trace.x.push(to - from); trace.base.push(from); trace.y.push(row(i) + 0.5); trace.text.push(about);
    };
    add(range, r.low, r.high);
    if (r.headroom > 0 && r.bars.length) add(spare, r.high - r.headroom, r.high);
    for (const [exponent, count, height] of r.bars) {
      bars.x.push(exponent + 0.5); bars.base.push(row(i)); bars.y.push(0.88 * height);
      bars.text.push(`${about}<br><b>${count}</b> values from 2^${exponent} to 2^${exponent + 1}`);
      bars.marker.color.push(exponent >= r.low && exponent < r.high ? colour("accent") : colour("alarm"));
    }
  });
  const axis = axisLayout("log2 |value|, each register in its own unit", { side: "bottom" });
  const labels = registers.map((r) => `${escaped(r.name)}  <span style="color:${colour("soft")}">${escaped(r.format.split(" ")[0])}</span>`);
  drawPlot(element, [range, spare, bars], layoutOf(90 + 26 * registers.length, { barmode: "overlay", xaxis: axis,
    legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom" },
    yaxis: axisLayout("", { tickvals: registers.map((_, i) => row(i) + 0.5), ticktext: labels, range: [0, registers.length],
      showgrid: false, zeroline: false, ticks: "", fixedrange: true }) }));
}

function drawBudget(element, budget) {
  const stacks = budget.stacks;
  const metrics = stacks.map((s) => escaped(s.metric) + (s.powers ? " (power)" : ""));
  const share = (stack, name) => 100 * stack.shares.filter((s) => s[0] === name).reduce((sum, s) => sum + s[1], 0);
  const rest = (stack) => 100 * stack.shares.filter((s) => !budget.names.includes(s[0])).reduce((sum, s) => sum + s[1], 0);
  const trace = (name, fill, value) => ({ name: escaped(name), type: "bar", orientation: "h", y: metrics, x: stacks.map(value),
    marker: { color: fill, line: { color: colour("ground"), width: 1 } },
    hovertemplate: `${escaped(name)}: %{x:.1f} %<extra>%{y}</extra>` });
  const traces = budget.names.map((name, i) => trace(name, PALETTE[i % PALETTE.length], (s) => share(s, name)));
  if (stacks.some((s) => rest(s) > 0)) traces.push(trace("all others", colour("fail"), rest));
  if (stacks.some((s) => s.common > 0.001)) traces.push(trace("common to all", colour("range"), (s) => 100 * s.common));
  drawPlot(element, traces, layoutOf(130 + 30 * stacks.length, { barmode: "stack", bargap: 0.3,
    xaxis: axisLayout("error with this quantisation alone [% of the whole error; power: of its square]"),
    yaxis: axisLayout("", { autorange: "reversed", ticks: "" }), legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom", traceorder: "normal" },
    shapes: [{ type: "line", yref: "paper", y0: 0, y1: 1, xref: "x", x0: 100, x1: 100, line: { color: colour("text"), width: 1.5 } }] }));
}

function drawBounds(element, rows) {
  const names = rows.map((r) => escaped(r[0]));
  const values = rows.flatMap((r) => [toNumber(r[1]), toNumber(r[2])]);
  const scale = scaleFor(values, "error, each place in its own unit", "x");
  const observed = rows.map((r) => scale.place(toNumber(r[2]))), bound = rows.map((r) => scale.place(toNumber(r[1])));
  const between = { type: "scatter", mode: "lines", x: [], y: [], line: { color: colour("fail"), width: 2 }, hoverinfo: "skip", showlegend: false };
  rows.forEach((_, i) => { between.x.push(observed[i], bound[i], null); between.y.push(names[i], names[i], null); });
  const text = rows.map((r) => `<b>${escaped(r[0])}</b><br>observed ${textOf(toNumber(r[2]))}<br>bound ${textOf(toNumber(r[1]))}` +
    `<br>${r[3]}${r[4] ? ": observed above the bound" : " of the bound"}`);
  const marks = (name, x, marker) => ({ name, type: "scatter", mode: "markers", x, y: names, text, marker,
    hovertemplate: "%{text}<extra></extra>" });
  drawPlot(element, [between,
    marks("largest observed", observed, { size: 9, color: rows.map((r) => (r[4] ? colour("alarm") : colour("accent"))) }),
    marks("proved bound", bound, { symbol: "line-ns-open", size: 13, color: colour("text"), line: { width: 2.5 } })],
  layoutOf(110 + 24 * rows.length, { xaxis: scale.layout, shapes: scale.shapes, annotations: scale.annotations,
    yaxis: axisLayout("", { type: "category", autorange: "reversed", ticks: "" }) }));
}
