// The three charts: error against time, frame rate against trees, error against distance.
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
    const views = row.views.filter((view) => view.length > 2).map((view) => errorsOfView(view)).filter((error) => error !== null);
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

const startDistance = () => {
  const at = figure("live-distance", "");
  const redraw = () => {
    const list = rowsOf(chosen.group).filter((row) => seen(row) && errorOf(row) !== null);
    const points = [], lines = [];
    for (const row of list) {
      const of = row.views.filter((view) => view.length > 2 && view[1] > 0 && errorsOfView(view) !== null)
        .map((view) => [view[1], errorsOfView(view)]).sort((a, b) => a[0] - b[0]);
      for (const [x, y] of of) points.push({ row, x, y, filled: variantOf(row) === 0 });
      lines.push({ color: row.method.color, dash: dashes[variantOf(row) % dashes.length], points: of });
    }
    const xs = points.map((point) => point.x), far = Math.max(...xs), near = Math.min(...xs);
    const walks = points.length && far > 1.1 * near;
    at.again.replaceChildren(walks ? redo(list) : "");
    if (!walks) {
      at.chartPlace.replaceChildren(make("p.soft", null, points.length
        ? `In ${chosen.group.title} the camera keeps its distance to the trees (${plain(near)} to ${plain(far)} m); a scene that walks or flies in shows how errors grow near by.`
        : "No cell that is switched on here was compared."));
      at.below.replaceChildren("");
      return;
    }
    chart(at.chartPlace, {
      points, lines: lines.filter((line) => line.points.length), label: `${metric().heading} against distance`,
      xTitle: "median distance to the trees in view [m]", yTitle: `${metric().heading}, reference with ${effectsText()}`,
      x: logAxis(xs, 0.04, 0.04), y: logAxis(points.map((point) => point.y), 0.08, 0.08),
    });
    at.below.replaceChildren(`${chosen.group.title}. One point a view; the lines join the views of a cell.`);
  };
  onChange(redraw);
  keepWidth(at.chartPlace, redraw);
};
