// The charts: error against time, frame rate against trees, error against distance and view angle.
"use strict";
const timeAxis = () => (chosen.rate ? "frames a second" : "time a frame [ms]");
const asTime = (secondsValue) => (chosen.rate ? 1 / secondsValue : 1e3 * secondsValue);
const timesOf = (row) => {
  const ends = ["frame_seconds_low", "frame_seconds_high"].map((key) => asTime(valueOf(row, key))).sort((a, b) => a - b);
  return [asTime(valueOf(row, "frame_seconds")), ...ends];
};
const dashes = [null, "6 3", "2 3", "8 3 2 3", "1 3"];
// Series of one method differ by dashes.
const variantOf = (() => {
  const known = new Map();
  for (const row of rows) {
    if (!known.has(row.method)) known.set(row.method, []);
    if (!known.get(row.method).includes(row.series)) known.get(row.method).push(row.series);
  }
  return (row) => known.get(row.method).indexOf(row.series);
})();

// A piece of the line and a point, as the charts draw them.
const sampleOf = (row) => {
  const variant = variantOf(row), sample = draw("svg", { class: "sample", viewBox: "0 0 34 12", "aria-hidden": "true", style: `color:var(--${row.method.color})` });
  sample.append(draw("path", { class: "line", d: "M0 6H34", "stroke-dasharray": dashes[variant % dashes.length] }),
    symbolAt({ row, filled: variant === 0 }, 17, 6, 4));
  return sample;
};

// Nothing else is both faster and closer; fastest first.
const frontOf = (list) => {
  const front = [];
  const sorted = list.slice().sort((a, b) => valueOf(a, "frame_seconds") - valueOf(b, "frame_seconds") || errorOf(a) - errorOf(b));
  for (const row of sorted)
    if (!front.length || errorOf(row) < errorOf(front[front.length - 1])) front.push(row);
  return front;
};

const figure = (id, caption) => {
  const chartPlace = make("div.chart-place"), below = make("figcaption", null, caption), again = make("div");
  place(id).replaceChildren(make("figure.figure", null, chartPlace, below, again));
  return { chartPlace, below, again };
};

// Clickable names: a method that is switched off is off in every chart.
const legend = (methods) => make("p.legend", null, methods.map((method) =>
  make("button.chip", {
    type: "button", "aria-pressed": chosen.hidden.has(method) ? "false" : "true",
    click: () => {
      chosen.hidden.has(method) ? chosen.hidden.delete(method) : chosen.hidden.add(method);
      change({});
    },
  }, markOf(method), method.name)));

const tradeSpec = (list) => {
  const front = frontOf(list), points = [];
  for (const row of list) {
    const views = comparedViews(row).map((view) => errorsOfView(view)).filter((error) => error !== null);
    const [x, x0, x1] = timesOf(row), on = front.includes(row);
    points.push({ row, x, x0, x1, y: errorOf(row), y0: Math.min(...views), y1: Math.max(...views), filled: on, note: on ? row.variant : "" });
    if (!views.length) points[points.length - 1].y0 = points[points.length - 1].y1 = errorOf(row);
  }
  const rules = [], noise = chosen.effects === "same" ? Math.max(...list.map((row) => asError(valueOf(row, `floor_${metric().key}`)) ?? 0)) : 0;
  const lowest = Math.min(...points.flatMap((point) => [point.y0, point.y].filter((value) => value > 0)));
  if (noise > lowest / 20) rules.push({ y: noise, text: "noise of the reference" });
  const floor = rowsOf(chosen.group).find((row) => row.floor), floorAt = floor && asTime(valueOf(floor, "frame_seconds"));
  const x = (extra) => logAxis(points.flatMap((point) => [point.x0, point.x1]).concat(extra), 0.08, 0.05);
  if (floor && x([floorAt]).high / x([floorAt]).low < 30 * (x([]).high / x([]).low)) rules.push({ x: floorAt, text: "no trees (null)" });
  const spec = {
    points, rules, label: `${metric().heading} against ${timeAxis()}`, xTitle: timeAxis(),
    yTitle: `${metric().heading}, reference with ${effectsText()}`,
    x: x(rules.filter((rule) => rule.x).map((rule) => rule.x)),
    y: logAxis(points.flatMap((point) => [point.y0, point.y1, point.y]).concat(rules.filter((rule) => rule.y).map((rule) => rule.y)), 0.08, 0.08),
  };
  const corners = front.map((row) => [asTime(valueOf(row, "frame_seconds")), Math.max(errorOf(row), spec.y.low)]);
  if (front.length)
    spec.lines = [{ color: "muted", dash: "5 4", steps: true,
      points: [[corners[0][0], spec.y.high], ...corners, [chosen.rate ? spec.x.low : spec.x.high, corners[corners.length - 1][1]]] }];
  return spec;
};

const startTrade = () => {
  const at = figure("live-trade", "");
  const redraw = () => {
    const all = rowsOf(chosen.group).filter((row) => row.ok && !row.floor);
    const list = all.filter((row) => seen(row) && errorOf(row) !== null && valueOf(row, "frame_seconds") > 0);
    if (list.length) chart(at.chartPlace, tradeSpec(list));
    else at.chartPlace.replaceChildren(make("p.soft", null, "No cell that is switched on here has both a frame time and an error."));
    at.below.replaceChildren(
      legend([...new Set(all.map((row) => row.method))]),
      `${chosen.group.title}. ${count(list.length, "cell")}; filled and joined: the front, nothing else is both faster and closer. `,
      "Across: 95 % interval of the time; up and down: best and worst view. A click leads to the cell.");
    at.again.replaceChildren(list.length ? redo(list) : "");
  };
  onChange(redraw);
  keepWidth(at.chartPlace, redraw);
};

const lawText = (law) => {
  if (law.b === undefined || law.b === null) return "too few tree counts for a law";
  const sign = chosen.rate ? -1 : 1, ends = [sign * law.low, sign * law.high].sort((a, b) => a - b);
  const number = (value) => (value <= -0.005 ? "\u2212" : "") + Math.abs(value).toFixed(2);
  return `${chosen.rate ? "fps" : "time"} \u223c N^${number(sign * law.b)} (${number(ends[0])} to ${number(ends[1])}), R\u00b2 ${law.r2.toFixed(2)}`;
};

const startGrowth = () => {
  const at = figure("live-growth", "");
  const redraw = () => {
    const laws = data.laws.filter((law) => law.family === chosen.group.family && !chosen.hidden.has(rows[law.rows[0]].method));
    const list = laws.flatMap((law) => law.rows.map((index) => rows[index]));
    const trees = new Set(list.map((row) => row.group.trees));
    at.again.replaceChildren("");
    if (trees.size < 2) {
      at.chartPlace.replaceChildren(make("p.soft", null, `${data.families[chosen.group.family]} was drawn with one tree count; a plan with several shows the growth.`));
      at.below.replaceChildren("");
      return;
    }
    const points = [], lines = [];
    for (const law of laws) {
      const of = law.rows.map((index) => rows[index]), color = of[0].method.color, dash = dashes[variantOf(of[0]) % dashes.length];
      for (const row of of) {
        const [y, y0, y1] = timesOf(row);
        points.push({ row, x: row.group.trees, y, y0, y1, filled: variantOf(row) === 0 });
      }
      const fitted = (n) => [n, asTime(law.a * n ** law.b)];
      lines.push({ color, dash, points: law.b === undefined || law.b === null
        ? of.map((row) => [row.group.trees, timesOf(row)[0]]) : [fitted(of[0].group.trees), fitted(of[of.length - 1].group.trees)] });
    }
    chart(at.chartPlace, {
      points, lines, label: `${timeAxis()} against trees`, xTitle: "trees", yTitle: timeAxis(),
      x: logAxis(points.map((point) => point.x), 0.04, 0.04),
      y: logAxis(points.flatMap((point) => [point.y0, point.y1]), 0.08, 0.08),
    });
    at.below.replaceChildren(
      make("ul.laws", null, laws.slice(0, 40).map((law) => make("li", null, sampleOf(rows[law.rows[0]]), make("b", null, data.series[law.series]), " ", lawText(law)))),
      "Bars: 95 % intervals of the medians. Straight lines: the power laws of the table below.");
    at.again.replaceChildren(redo(list));
  };
  onChange(redraw);
  keepWidth(at.chartPlace, redraw);
};

// Error against what the camera changes: column of a view, axes, words. An angle counts where the distance is kept.
const degreeAxis = (values) => {
  const low = Math.min(...values), high = Math.max(...values), margin = 0.02 * (high - low) || 1;
  const step = [1, 2, 5, 10, 15, 30, 45, 90].find((size) => high - low <= 9 * size) || 90, ticks = [];
  for (let tick = Math.ceil(low / step) * step; tick <= high + 1e-6; tick += step) ticks.push(tick);
  const at = (value) => (value - low + margin) / (high - low + 2 * margin);
  return { low: low - margin, high: high + margin, ticks, text: (tick) => `${tick}\u00b0`, at };
};
const viewAxes = {
  distance: { column: 1, xTitle: "median distance to the trees in view [m]", axis: (xs) => logAxis(xs, 0.04, 0.04) },
  elevation: { column: 2, xTitle: "elevation of the eye above the trees", axis: degreeAxis },
  azimuth: { column: 3, xTitle: "azimuth of the eye around the trees", axis: degreeAxis },
};
const goes = (word, list) => {
  const ends = (column) => {
    const values = list.flatMap((row) => comparedViews(row).map((view) => view[column])).filter((value) => value !== null);
    return [Math.min(...values), Math.max(...values)];
  };
  const [near, far] = ends(1), walks = far > 1.1 * near;
  if (word === "distance" || walks) return word === "distance" && walks;
  const [low, high] = ends(viewAxes[word].column);
  return high - low >= 10 && list.every((row) => comparedViews(row).length > 2);
};

const viewsSpec = (word, list) => {
  const { column, xTitle, axis } = viewAxes[word], points = [], lines = [], noise = new Map();
  for (const row of list) {
    const views = comparedViews(row).filter((view) => view[column] !== null && errorsOfView(view) !== null).sort((a, b) => a[column] - b[column]);
    const of = views.map((view) => [view[column], errorsOfView(view)]);
    for (const view of views) noise.set(view[column], Math.max(noiseOfView(view) ?? 0, noise.get(view[column]) ?? 0));
    for (const [x, y] of of) points.push({ row, x, y, filled: variantOf(row) === 0 });
    if (of.length) lines.push({ color: row.method.color, dash: dashes[variantOf(row) % dashes.length], points: of });
  }
  const ys = points.map((point) => point.y), floor = [...noise].sort((a, b) => a[0] - b[0]);
  const noisy = chosen.effects === "same" && Math.max(...noise.values()) > Math.min(...ys.filter((y) => y > 0)) / 20;
  if (noisy) lines.push({ color: "muted", dash: "1 3", points: floor });
  return {
    points, lines, noisy, label: `${metric().heading} against ${word}`, xTitle,
    yTitle: `${metric().heading}, reference with ${effectsText()}`,
    x: axis(points.map((point) => point.x)), y: logAxis(ys.concat(noisy ? floor.map(([, y]) => y) : []), 0.08, 0.08),
  };
};

const startViews = (word, missing) => {
  if (!place(`live-${word}`)) return;
  const at = figure(`live-${word}`, "");
  const redraw = () => {
    const list = rowsOf(chosen.group).filter((row) => seen(row) && errorOf(row) !== null);
    const there = list.length && goes(word, list);
    at.again.replaceChildren(there ? redo(list) : "");
    at.below.replaceChildren("");
    if (!there) {
      at.chartPlace.replaceChildren(make("p.soft", null, list.length ? missing() : "No cell that is switched on here was compared."));
      return;
    }
    const spec = viewsSpec(word, list);
    chart(at.chartPlace, spec);
    at.below.replaceChildren(`${chosen.group.title}. One point a view; the lines join the views of a cell.${spec.noisy ? " Dotted: the noise of the reference." : ""}`);
  };
  onChange(redraw);
  keepWidth(at.chartPlace, redraw);
};
const startDistance = () => startViews("distance", () =>
  `In ${chosen.group.title} the camera keeps its distance to the trees; a scene that walks or flies in shows how errors grow near by.`);
const startAngles = () => {
  startViews("elevation", () => `In ${chosen.group.title} the camera does not rise at one distance; view-elevation is a scene where it does.`);
  startViews("azimuth", () => `In ${chosen.group.title} the camera does not go around at one distance; view-azimuth is a scene where it does.`);
};
