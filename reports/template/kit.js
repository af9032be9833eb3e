// What all parts of the page share: the data, what the reader chose, numbers for people, elements.
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const columns = Object.fromEntries(data.columns.map((column) => [column.key, column]));
const rows = data.rows.map(([group, series, method, state, name, variant, message, views, bound], index) => ({
  index, series, state, name, variant, message, views, bound,
  group: data.groups[group],
  method: data.methods[method],
  label: data.series[series],
  ok: state === "ok" || state === "floor",
  floor: state === "floor",
}));
const valueOf = (row, key) => columns[key].values[row.index] ?? null;

// ---- What the reader chose. A change redraws every part that asked for it.
const chosen = { group: data.groups[0], metric: 0, effects: "same", rate: false, hidden: new Set() };
const parts = [];
const onChange = (draw) => parts.push(draw);
const change = (what) => {
  Object.assign(chosen, what);
  hideCard();
  for (const draw of parts) draw();
};
const rowsOf = (group) => rows.slice(group.first, group.first + group.count);
const seen = (row) => row.ok && !row.floor && !chosen.hidden.has(row.method);

// ---- Errors. The metric's 1 - x form, where it has one, so that lower is always better.
const metric = () => data.metrics[chosen.metric];
const asError = (value) => (value === null || value === undefined ? null : metric().one_minus ? 1 - value : value);
const errorOf = (row, effects = chosen.effects) => asError(valueOf(row, `${effects}_${metric().key}`));
// A view: time, distance, elevation, azimuth and, where it was compared, errors and noise.
const VIEW_ERRORS = 4;
const whereOf = ([, distance, elevation, azimuth]) =>
  `${plain(distance)} m${elevation === null ? "" : `, ${plain(elevation, 2)}\u00b0 up, azimuth ${plain(azimuth)}\u00b0`}`;
const comparedViews = (row) => row.views.filter((view) => view.length > VIEW_ERRORS);
const errorsOfView = (view, effects = chosen.effects) =>
  asError(view[VIEW_ERRORS + chosen.metric + (effects === "full" ? data.metrics.length : 0)]);
const noiseOfView = (view) => asError(view[VIEW_ERRORS + chosen.metric + 2 * data.metrics.length]);
const effectsText = (effects = chosen.effects) => (effects === "same" ? "same effects" : "all effects");

// ---- Numbers for people; not measured is a dash.
const none = "\u2013";
const plain = (value, digits = 3) => {
  if (value === null || value === undefined || !Number.isFinite(value)) return none;
  if (value !== 0 && (Math.abs(value) < 1e-5 || Math.abs(value) >= 1e13)) return value.toExponential(digits - 1);
  const power = value === 0 ? 0 : Number(value.toExponential(digits - 1).split("e")[1]);
  let decimals = value === 0 ? 0 : Math.max(0, digits - 1 - power);
  if (Number.isInteger(value)) decimals = 0;
  return value.toFixed(decimals).replace(/^-?\d+/, (whole) => whole.replace(/\B(?=(\d{3})+$)/g, ","));
};
const short = (value, digits = 3) => {
  const suffixes = ["", " k", " M", " G", " T"];
  let step = 0;
  if (value === null || value < 1e5) return plain(value, digits);
  while (value >= 999.5 && step < 4) { value /= 1000; step++; }
  return plain(value, digits) + suffixes[step];
};
const seconds = (value) =>
  value === null ? none : Math.abs(value) < 1 ? plain(value * 1e3) + " ms" : plain(value) + " s";
const count = (n, word) => `${plain(n, 15)} ${word}${n === 1 ? "" : "s"}`;

// ---- Elements: make("p.soft", {title: "x"}, "text", child).
const build = (node, attributes, children) => {
  for (const [key, value] of Object.entries(attributes || {}))
    if (typeof value === "function") node.addEventListener(key, value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(key, value === true ? "" : value);
  node.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return node;
};
const make = (what, attributes, ...children) => {
  const [tag, ...classes] = what.split(".");
  const node = document.createElement(tag);
  if (classes.length) node.className = classes.join(" ");
  return build(node, attributes, children);
};
const draw = (tag, attributes, ...children) =>
  build(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
const place = (id) => document.getElementById(id);
const markOf = (method) => {
  const mark = draw("svg", { class: "mark", viewBox: "-1.5 -1.5 3 3", "aria-hidden": "true", style: `color:var(--${method.color})` });
  mark.innerHTML = method.symbol; // constants of the report
  return mark;
};
const linkTo = (row) => make("a.cell", { href: `#cell-${row.index + 1}` }, markOf(row.method), row.label);
const quoted = (text) => "'" + text.replace(/'/g, "'\\''") + "'";

const settings = data.settings ? data.settings + " " : "";
// The command that measures these cells again, as they were measured.
const redo = (cells) => {
  const of = (row) => `--cell ${quoted(row.name)}`;
  const measured = `./treeline run ${settings}--report`;
  return make("details.redo", null,
    make("summary", null, `Measure ${cells.length === 1 ? "this cell" : `these ${count(cells.length, "cell")}`} again`),
    make("pre", null, [measured, ...cells.slice(0, 200).map(of)].join(" \\\n  "),
      cells.length > 200 ? `\n# and ${cells.length - 200} more: see the CSV` : ""));
};
