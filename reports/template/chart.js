// One kind of chart: points with intervals and lines over two axes, drawn to the width of its place. The nearest point
// answers to the pointer; each point is a link to its cell.
"use strict";
const mantissas = [[1], [1, 3], [1, 2, 5], [1, 1.5, 2, 3, 5, 7], [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8]];

// A logarithmic axis over these values, widened by parts of its span; ticks as the static plots have them.
const logAxis = (values, below, above) => {
  const positive = values.filter((value) => value > 0 && Number.isFinite(value));
  const logs = positive.length ? positive.map(Math.log10) : [-1, 0];
  const least = logs.reduce((a, b) => Math.min(a, b)), most = logs.reduce((a, b) => Math.max(a, b));
  const middle = (least + most) / 2, half = Math.max((most - least) / 2, 0.25);
  const low = middle - half - below * 2 * half, high = middle + half + above * 2 * half;
  let ticks = [];
  for (const list of mantissas) {
    const step = 1 + Math.floor((Math.floor(high) - Math.floor(low)) / 9);
    ticks = [];
    for (let power = Math.floor(low); power <= high; power += step)
      for (const m of list) ticks.push(m * 10 ** power);
    ticks = ticks.filter((tick) => tick >= 10 ** low && tick <= 10 ** high);
    if (ticks.length >= 4) break;
  }
  const text = (tick) => (tick >= 1e6 ? `${+(tick / 1e6).toPrecision(3)}M` : tick >= 1e3 ? `${+(tick / 1e3).toPrecision(3)}k` : String(+tick.toPrecision(3)));
  const at = (value) => (Math.log10(Math.max(value, 10 ** low)) - low) / (high - low);
  return { low: 10 ** low, high: 10 ** high, ticks, text, at };
};

const symbolAt = (point, x, y, size) => {
  const mark = draw("g", { transform: `translate(${x.toFixed(1)} ${y.toFixed(1)}) scale(${size})`, class: point.filled ? "point filled" : "point" });
  mark.innerHTML = point.row.method.symbol; // constants of the report
  return mark;
};

// Finds places beside points where small texts cover neither points nor each other.
const noteWriter = (area, taken) => (x, y, text) => {
  const width = 6.1 * text.length;
  for (const [side, up] of [[-1, 1], [1, -1], [-1, 0], [1, 0], [1, 1], [-1, -1]]) {
    const start = x + side * 10, middle = y + up * 11;
    const box = [Math.min(start, start + side * width), middle - 7, Math.max(start, start + side * width), middle + 7];
    if (box[0] < area.left || box[2] > area.right || box[1] < area.top || box[3] > area.bottom) continue;
    if (taken.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])) continue;
    taken.push(box);
    return draw("text", { class: "note", x: start, y: middle + 4, "text-anchor": side < 0 ? "end" : "start" }, text);
  }
  return null;
};

const putAxes = (root, area, spec) => {
  const { x, y } = spec;
  for (const tick of y.ticks) {
    const at = area.toY(tick);
    root.append(draw("path", { class: "grid", d: `M${area.left} ${at}H${area.right}` }),
      draw("text", { class: "tick", x: area.left - 7, y: at + 4, "text-anchor": "end" }, y.text(tick)));
  }
  let free = -Infinity; // tick labels along x keep clear of each other
  for (const tick of x.ticks) {
    const at = area.toX(tick), half = 3.4 * x.text(tick).length;
    root.append(draw("path", { class: "grid", d: `M${at} ${area.top}V${area.bottom}` }));
    if (at - half < free) continue;
    free = at + half + 6;
    root.append(draw("text", { class: "tick", x: at, y: area.bottom + 17, "text-anchor": "middle" }, x.text(tick)));
  }
  root.append(draw("path", { class: "axis", d: `M${area.left} ${area.top}V${area.bottom}H${area.right}` }),
    draw("text", { class: "title", x: area.right, y: area.bottom + 36, "text-anchor": "end" }, spec.xTitle),
    draw("text", { class: "title", x: 2, y: 13 }, spec.yTitle));
};

const putRules = (root, area, rules) => {
  for (const rule of rules)
    if (rule.x !== undefined) {
      const at = area.toX(rule.x);
      root.append(draw("path", { class: "rule", d: `M${at} ${area.top}V${area.bottom}` }),
        draw("text", { class: "note", transform: `translate(${at - 4} ${area.top + 4}) rotate(-90)`, "text-anchor": "end" }, rule.text));
    } else {
      const at = area.toY(rule.y);
      root.append(draw("path", { class: "rule", d: `M${area.left} ${at}H${area.right}` }),
        draw("text", { class: "note", x: area.right - 2, y: at - 5, "text-anchor": "end" }, rule.text));
    }
};

const bar = (a, b, across, cap) =>
  a === b ? "" : across ? `M${a[0]} ${a[1]}H${b[0]}m0-${cap}v${2 * cap}M${a[0]} ${a[1] - cap}v${2 * cap}`
    : `M${a[0]} ${a[1]}V${b[1]}m-${cap} 0h${2 * cap}M${a[0] - cap} ${a[1]}h${2 * cap}`;

// Many points share one path a method; only those that matter are links then.
const LINKS_MAX = 600;
const putPoints = (root, area, points) => {
  const size = points.length > LINKS_MAX ? 2.5 : 5;
  const bars = new Map(), many = new Map();
  for (const point of points) {
    const x = area.toX(point.x), y = area.toY(point.y), color = point.row.method.color;
    point.at = [x, y];
    const slim = points.length > LINKS_MAX && !point.filled;
    if (slim) many.set(color, (many.get(color) || "") + `M${x.toFixed(1)} ${y.toFixed(1)}h.01`);
    if (slim) continue;
    let path = "";
    if (point.x0 !== undefined) path += bar([area.toX(point.x0), y], [area.toX(point.x1), y], true, 3);
    if (point.y0 !== undefined) path += bar([x, area.toY(point.y0)], [x, area.toY(point.y1)], false, 3);
    if (path) bars.set(color, (bars.get(color) || "") + path);
  }
  for (const [color, path] of many) root.append(draw("path", { class: "many", d: path, style: `color:var(--${color})` }));
  for (const [color, path] of bars) root.append(draw("path", { class: "bars", d: path, style: `color:var(--${color})` }));
  for (const point of points)
    if (points.length <= LINKS_MAX || point.filled)
      root.append(draw("a", {
        href: `#cell-${point.row.index + 1}`, class: "dot", style: `color:var(--${point.row.method.color})`,
        "aria-label": `${point.row.label}, ${point.row.group.title}`,
        focus: (event) => { if (dotOf(event.currentTarget)) showCardOf(event.currentTarget); },
        blur: () => { if (!card.classList.contains("touchable")) hideCard(); },
      }, symbolAt(point, ...point.at, size)));
};

const nearest = (points, x, y, reach) => {
  let best = null, least = reach * reach;
  for (const point of points) {
    const squared = (point.at[0] - x) ** 2 + (point.at[1] - y) ** 2;
    if (squared < least) { least = squared; best = point; }
  }
  return best;
};

// A finger has no hover: its first tap shows the card, the card's link leads on.
const listen = (root, points) => {
  const find = (event) => {
    const box = root.getBoundingClientRect();
    return nearest(points, event.clientX - box.left, event.clientY - box.top, 28);
  };
  root.addEventListener("pointermove", (event) => {
    if (event.pointerType === "touch") return;
    const point = find(event);
    root.style.cursor = point ? "pointer" : "";
    if (point) showCard(point.row, event.clientX, event.clientY);
    else hideCard();
  });
  root.addEventListener("pointerleave", (event) => { if (event.pointerType !== "touch") hideCard(); });
  root.addEventListener("click", (event) => {
    const point = event.detail ? find(event) : null; // the keyboard follows the link itself
    if (!point) return;
    event.preventDefault();
    if (event.pointerType === "touch") showCard(point.row, event.clientX, event.clientY, true);
    else goTo(point.row);
  });
};

// spec: x, y (axes), xTitle, yTitle, label, points, lines: [{color, points: [[x, y]], dash, steps, note}], rules.
const chart = (host, spec) => {
  const width = Math.max(280, host.clientWidth), height = Math.round(Math.min(Math.max(width * 0.56, 270), 470));
  const area = { left: 48, right: width - 10, top: 24, bottom: height - 44 };
  area.toX = (value) => +(area.left + spec.x.at(value) * (area.right - area.left)).toFixed(1);
  area.toY = (value) => +(area.bottom - spec.y.at(value) * (area.bottom - area.top)).toFixed(1);
  const root = draw("svg", { class: "chart", width, height, viewBox: `0 0 ${width} ${height}`, role: "group", "aria-label": spec.label });
  putAxes(root, area, spec);
  putRules(root, area, spec.rules || []);
  for (const line of spec.lines || []) {
    const path = line.points.map(([x, y], i) =>
      i === 0 ? `M${area.toX(x)} ${area.toY(y)}` : line.steps ? `H${area.toX(x)}V${area.toY(y)}` : `L${area.toX(x)} ${area.toY(y)}`);
    root.append(draw("path", { class: "line", d: path.join(""), style: `color:var(--${line.color})`, "stroke-dasharray": line.dash || null }));
    const [x, y] = line.points[line.points.length - 1];
    if (line.note)
      root.append(draw("text", { class: "note", x: area.toX(x) - 10, y: area.toY(y) + 1, "text-anchor": "end" }, line.note));
  }
  putPoints(root, area, spec.points);
  const write = noteWriter(area, spec.points.slice(0, 400).map(({ at: [x, y] }) => [x - 6, y - 6, x + 6, y + 6]));
  for (const point of spec.points)
    if (point.note && width > 460) root.append(write(...point.at, point.note) || "");
  listen(root, spec.points);
  host.replaceChildren(root);
};

// Redraws when its place gets another width.
const keepWidth = (host, redraw) => {
  let width = 0;
  new ResizeObserver(() => {
    if (host.clientWidth === width || !host.clientWidth) return;
    width = host.clientWidth;
    redraw();
  }).observe(host);
};
