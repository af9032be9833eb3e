// Stacked bars, a row a cell: where the error comes from, memory, build time.
"use strict";
const BARS_MAX = 60;

// parts: [{name, of: row => number or null}], drawn solid, hatched, outlined. Sorted by the sum.
const bars = (list, barParts, format, noteOf = () => "") => {
  const sums = list.map((row) => ({ row, values: barParts.map((part) => Math.max(0, part.of(row) ?? 0)) }))
    .map((item) => ({ ...item, sum: item.values.reduce((a, b) => a + b, 0) })).sort((a, b) => a.sum - b.sum);
  const most = Math.max(...sums.map((item) => item.sum), Number.MIN_VALUE);
  const key = make("p.legend", null, barParts.map((part, i) => make("span", null, make(`span.swatch.part${i}`), part.name)));
  const table = make("div.bars", { role: "list" }, sums.slice(0, BARS_MAX).map(({ row, values, sum }) =>
    make("div.bar-row", { role: "listitem", title: barParts.map((part, i) => `${part.name} ${format(part.of(row))}`).join(", ") },
      make("span.bar-name", null, linkTo(row)),
      make("span.bar-track", { style: `color:var(--${row.method.color})` },
        values.map((value, i) => make(`span.part${i}`, { style: `width:${((100 * value) / most).toFixed(2)}%` }))),
      make("span.bar-value", null, format(sum), make("span.soft", null, noteOf(row))))));
  return [key, table, sums.length > BARS_MAX ? make("p.soft", null, `The first ${BARS_MAX} of ${count(sums.length, "cell")}.`) : ""];
};

const startSplit = () => {
  const redraw = () => {
    const list = rowsOf(chosen.group).filter((row) => seen(row) && errorOf(row, "same") !== null);
    const cancels = (row) => errorOf(row, "full") < errorOf(row, "same");
    place("live-split").replaceChildren(
      make("p", null, "The error of the ", make("b", null, "representation"), " is taken against a reference with exactly the effects that the method draws; what is added against a reference with all effects that the scene asks for comes from the ",
        make("b", null, "missing effects"), "."),
      ...(list.length ? bars(list, [
        { name: `representation, ${metric().heading}`, of: (row) => errorOf(row, "same") },
        { name: "missing effects", of: (row) => errorOf(row, "full") - errorOf(row, "same") },
      ], (value) => plain(value), (row) => (cancels(row) ? ` (against all effects ${plain(errorOf(row, "full"))}: the two cancel)` : ""))
        : [make("p.soft", null, "No cell that is switched on here was compared.")]),
      list.length ? redo(list) : "");
  };
  onChange(redraw);
  redraw();
};

const startCost = () => {
  const part = (name, key, scale) => ({ name, of: (row) => (valueOf(row, key) === null ? null : valueOf(row, key) * scale) });
  const redraw = () => {
    const list = rowsOf(chosen.group).filter(seen);
    const panel = (title, ...of) => make("div.panel", null, make("h3", null, title), ...(list.length ? bars(list, ...of) : [make("p.soft", null, "No cell is switched on here.")]));
    place("live-cost").replaceChildren(
      make("div.panels", null,
        panel("Memory that it keeps [MB]", [part("method", "host_bytes", 1e-6), part("GL objects", "device_bytes", 1e-6), part("plants", "plant_bytes", 1e-6)], (value) => plain(value)),
        panel("Time before the first picture [s]", [part("prepare, cold", "build_seconds", 1), part("plants built", "plant_seconds", 1), part("first frame", "first_frame_seconds", 1)], (value) => plain(value))),
      make("p.soft", null, chosen.group.title + "."), list.length ? redo(list) : "");
  };
  onChange(redraw);
  redraw();
};
