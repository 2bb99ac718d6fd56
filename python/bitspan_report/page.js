// SPDX-License-Identifier: Apache-2.0
"use strict";
// The page's data, menus, and the panel that shows one configuration. Text from the database enters the page only
// as text nodes, or through escaped() into what plotly.js reads as its subset of HTML.

const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const shown = { point: null, x: data.x[0], y: data.y[0] };

function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

function escaped(text) {
  return String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
}

// Returns a stored number. null is NaN, and infinities are text.
function toNumber(value) {
  if (value === "inf") return Infinity;
  if (value === "-inf") return -Infinity;
  return value === null ? NaN : value;
}

const ARRAYS = { Uint8Array, Int8Array, Uint16Array, Int32Array, Float32Array, Float64Array };

// Returns the array that packed() of data.py wrote. It is unpacked once.
function unpacked(stored) {
  if (!stored.values) {
    const text = atob(stored.bytes), bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    stored.values = new ARRAYS[stored.array](bytes.buffer);
    stored.bytes = null;
  }
  return stored.values;
}

// Returns a metric's value of every point.
function columnOf(metric) {
  const column = data.metrics[metric];
  if (!column.floats) {
    const table = unpacked(column.table), at = column.at && unpacked(column.at);
    column.floats = column.at === null ? table : Float64Array.from({ length: data.count }, (_, i) => table[at ? at[i] : 0]);
  }
  return column.floats;
}

function metricAt(metric, index) {
  const { table, at } = data.metrics[metric];
  return unpacked(table)[at === null ? index : at ? unpacked(at)[index] : 0];
}

const packedTextAt = (column, index) => column.table[unpacked(column.at)[index]];

// Returns the scene that decides at a point what a constraint judges; "" where it is no scene alone.
function sceneAt(metric, index) {
  const { scene } = data.metrics[metric];
  return scene ? packedTextAt(scene, index) : "";
}

function hashOf(index) {
  const { digits, texts } = data.hashes;
  if (texts) return texts[index];
  const bytes = unpacked(data.hashes).subarray(index * digits / 2, (index + 1) * digits / 2);
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

// Returns whether all constraints hold; null where nothing says.
function holdsAt(index) {
  const holds = unpacked(data.holds)[index];
  return holds < 0 ? null : holds === 1;
}

// Returns why a point was refused; null where it was not.
const refusalOf = (index) => packedTextAt(data.refusals, index);

// Returns [key, value] of every key that the point sets.
function settingsOf(index) {
  return Object.entries(data.settings).map(([key, column]) => [key, packedTextAt(column, index)]).filter((s) => s[1] !== null);
}

// Returns the indices of the points that fail no constraint and that no other such point beats or equals in both
// metrics, by rising cost. The rule is that of pareto_front in analysis.py.
const fronts = new Map();
function frontOf(x, y) {
  const name = JSON.stringify([x, y]);
  if (fronts.has(name)) return fronts.get(name);
  const costs = columnOf(x), errors = columnOf(y), holds = unpacked(data.holds);
  const signs = [x, y].map((metric) => (data.high.includes(metric) ? -1 : 1));
  const best = new Map();  // the best point of each cost
  for (let i = 0; i < data.count; ++i) {
    if (holds[i] === 0 || !Number.isFinite(costs[i]) || !Number.isFinite(errors[i])) continue;
    const other = best.get(costs[i]);
    if (other === undefined || signs[1] * errors[i] < signs[1] * errors[other]) best.set(costs[i], i);
  }
  let lowest = Infinity;
  const front = [...best.values()].sort((a, b) => signs[0] * (costs[a] - costs[b])).filter((i) => {
    const below = signs[1] * errors[i] < lowest;
    if (below) lowest = signs[1] * errors[i];
    return below;
  });
  fronts.set(name, front);
  return front;
}

function textOf(value) {
  if (typeof value !== "number") return String(value);
  if (Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  return Number.isInteger(value) && Math.abs(value) < 1e7 ? String(value) : String(Number(value.toPrecision(4)));
}

const titleOf = (metric) => (data.units[metric] ? `${metric} [${data.units[metric]}]` : metric);

function configOf(index) {
  const delta = data.configs[index];
  if (delta === undefined || typeof delta === "string") return delta || "";
  return data.baseConfig.map((line, i) => (i in delta ? delta[i] : line)).join("\n");
}

const quoted = (text) => (/^[\w./-]+$/.test(text) ? text : `'${text.replace(/'/g, "'\\''")}'`);
const replayOf = (index) => `bitspan study --db ${quoted(data.database)} --replay ${hashOf(index)}`;

// The clipboard needs a permission that a page opened as a file may lack.
async function copy(text, button) {
  let done = true;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = make("textarea", { value: text });
    document.body.append(area);
    area.select();
    done = document.execCommand("copy");
    area.remove();
  }
  const mark = make("span", { className: "copied", textContent: done ? "copied" : "not permitted: select the text" });
  button.after(mark);
  setTimeout(() => mark.remove(), 1800);
}

function tableOf(head, rows) {
  const numeric = head.map((_, i) => rows.length > 0 && rows.every((row) => typeof row[i] === "number"));
  const cell = (tag, value, i) => make(tag, { className: numeric[i] ? "n" : "long", textContent: textOf(value) });
  return make("table", {}, make("thead", {}, make("tr", {}, ...head.map((h, i) => cell("th", h, i)))),
    make("tbody", {}, ...rows.map((row) => make("tr", {}, ...row.map((value, i) => cell("td", value, i))))));
}

function copyButton(label, kind, index) {
  const button = make("button", { textContent: label });
  button.dataset.copy = kind;
  button.dataset.index = index;
  return button;
}

function metricsPart(index) {
  const names = Object.keys(data.metrics).filter((name) => !Number.isNaN(metricAt(name, index)));
  const box = make("div", { className: "scroll", tabIndex: 0 });
  const filter = make("input", { type: "search", placeholder: "filter, e.g. span.u", ariaLabel: "filter metrics" });
  const first = [shown.y, shown.x].filter((name) => names.includes(name));
  const ordered = [...first, ...names.filter((name) => !first.includes(name))];
  const fill = () => {
    const matching = ordered.filter((name) => name.includes(filter.value.trim()));
    box.replaceChildren(tableOf(["metric", "value", "unit"],
      matching.map((name) => [name, metricAt(name, index), data.units[name] || ""])));
  };
  filter.addEventListener("input", fill);
  fill();
  return [make("h3", { textContent: `Metrics (${names.length})` }), filter, make("div", { style: "height:6px" }), box];
}

// Returns what each constraint judges at a point, and on which scene.
function judgedPart(index) {
  const rows = data.limits.filter(({ metric }) => metric in data.metrics).map(({ text, metric }) =>
    [text, metricAt(metric, index), sceneAt(metric, index) || "–"]);
  return rows.length ? [tableOf(["constraint", "judged", "scene"], rows)] : [];
}

function areaPart(areas) {
  const describe = (a) => (a.status === "ok"
    ? Object.entries(a.values).map(([name, value]) => `${textOf(value)} ${name.replace("_", " ")}`).join(", ")
    : `${a.status.replace(/_/g, " ")}${a.message ? ": " + a.message : ""}`);
  const rows = areas.map((a) => [`${a.name}, ${a.placed ? "placed" : "synthesised"}`, describe(a)]);
  return [make("h3", { textContent: "Area" }), tableOf(["family", "result"], rows)];
}

// Shows the settings, metrics, TOML and replay command of a point, beside the Pareto plot.
function showPoint(index) {
  const panel = byId("detail");
  if (!panel) return;
  const hash = hashOf(index), number = unpacked(data.numbers)[index], refusal = refusalOf(index), holds = holdsAt(index);
  const config = configOf(index);
  shown.point = index;
  const names = [data.recommended.includes(index) && "recommended", index === data.base && "base",
    number >= 0 && `point ${number}`].filter(Boolean);
  const parts = [make("h3", {}, `${names.join(", ") || "point"} `, make("code", { textContent: hash.slice(0, 12) })),
    ...(config ? [copyButton("Copy TOML", "toml", index), " "] : []), copyButton("Copy replay command", "replay", index)];
  if (refusal !== null) parts.push(make("p", { className: "bad", textContent: `refused: ${refusal}` }));
  if (holds !== null && refusal === null) {
    parts.push(make("p", { className: holds ? "ok" : "bad",
      textContent: holds ? "holds all constraints" : "fails a constraint" }));
  }
  if (refusal === null) parts.push(...judgedPart(index));
  const same = refusal !== null ? [index] : pointsAtPlace(index);
  if (same.length > 1) {
    parts.push(make("p", { className: "note",
      textContent: `${same.indexOf(index) + 1} of ${same.length} points at this place of the plot; click it again for the next.` }));
  }
  const settings = settingsOf(index);
  if (settings.length) parts.push(tableOf(["setting", "value"], settings.map(([key, value]) => [key, String(value)])));
  else parts.push(make("p", { className: "note", textContent: "as the base" }));
  if (refusal === null) parts.push(...metricsPart(index));
  if (data.areas[index]) parts.push(...areaPart(data.areas[index]));
  parts.push(make("h3", { textContent: "Runs it again" }), make("pre", { className: "replay", textContent: replayOf(index) }));
  if (config) parts.push(make("h3", { textContent: "TOML" }), make("pre", { className: "toml", textContent: config }));
  else parts.push(make("p", { className: "note", textContent:
    "The database keeps the TOML of the base and of recommended points only: this is the base's with the settings above." }));
  panel.replaceChildren(...parts);
  panel.dataset.hash = hash;
  markPoint();
}

function fillMenu(menu, names, chosen) {
  menu.replaceChildren(...names.map((name) => make("option", { value: name, textContent: titleOf(name) })));
  menu.value = chosen;
}

// Shows the next (1) or previous (-1) point of the front, seen from the shown one.
function stepAlongFront(direction) {
  const front = frontOf(shown.x, shown.y);
  if (!front.length) return;
  const at = front.indexOf(shown.point);
  const next = at < 0 ? (direction > 0 ? 0 : front.length - 1) : Math.min(Math.max(at + direction, 0), front.length - 1);
  showPoint(front[next]);
}

function startParetoMenus() {
  if (!byId("pareto-plot")) return;
  for (const [id, names, which] of [["pareto-x", data.x, "x"], ["pareto-y", data.y, "y"]]) {
    fillMenu(byId(id), names, names[0]);
    byId(id).addEventListener("change", (event) => {
      shown[which] = event.target.value;
      drawPareto();
      if (shown.point !== null) showPoint(shown.point);
    });
  }
  tellLeftOut();
  byId("pareto-previous").addEventListener("click", () => stepAlongFront(-1));
  byId("pareto-next").addEventListener("click", () => stepAlongFront(1));
}

// Names the metrics that the page has no room for, and where they are.
function tellLeftOut() {
  if (!data.leftOut.length) return;
  const query = `sqlite3 ${quoted(data.database)} "SELECT name, value FROM point_values WHERE hash = 'HASH'"`;
  byId("pareto-plot").after(make("details", { id: "left-out" },
    make("summary", { textContent: `${data.leftOut.length} metrics are not in this page, which has no room for them` }),
    make("p", { className: "note" }, "All metrics of a point: ", make("code", { textContent: query })),
    make("p", { textContent: data.leftOut.join(", ") })));
}

function startWidthsMenu() {
  if (!byId("widths-y")) return;
  fillMenu(byId("widths-y"), data.y, data.y[0]);
  byId("widths-y").addEventListener("change", drawWidths);
}

// Sets up the menus that show one of several blocks.
function startVariants() {
  for (const menu of document.querySelectorAll("select.variants")) {
    menu.addEventListener("change", () => {
      for (const block of menu.closest("section").querySelectorAll(".variant")) {
        block.hidden = block.dataset.hash !== menu.value;
      }
      drawVariants();
      refreshViewers();
    });
  }
}

function startClicks() {
  document.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    if (button.dataset.copy) {
      const index = Number(button.dataset.index);
      copy(button.dataset.copy === "toml" ? configOf(index) : replayOf(index), button);
    } else if (button.dataset.point !== undefined) {
      showPoint(Number(button.dataset.point));
      if (byId("pareto")) byId("pareto").scrollIntoView();
    }
  });
}

function drawAll() {
  drawPareto();
  markPoint();
  setTimeout(drawBelow);  // so that the first plot is seen before the others are drawn
}

function drawBelow() {
  drawWidths();
  drawSearch();
  for (const plot of document.querySelectorAll("[data-plot]")) delete plot.dataset.drawn;
  drawVariants();
}

window.addEventListener("DOMContentLoaded", () => {
  startParetoMenus();
  startWidthsMenu();
  startVariants();
  startClicks();
  startViewers();
  drawAll();
  const first = data.recommended.length ? data.recommended[0] : data.base;
  if (first !== null) showPoint(first);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawAll);
});
