// The chart of the machine's limits: frames a second that a cell reached, against those that the resource which binds it
// would allow.
"use strict";
const allowedOf = (row) => {
  const fraction = valueOf(row, "limit_fraction"), time = valueOf(row, "frame_seconds");
  return fraction > 0 && time > 0 ? 1 / (fraction * time) : null;
};

const limitSpec = (list) => {
  const points = list.map((row) => ({
    row, x: allowedOf(row), y: 1 / valueOf(row, "frame_seconds"), y0: 1 / valueOf(row, "frame_seconds_high"),
    y1: 1 / valueOf(row, "frame_seconds_low"), filled: true, note: row.bound,
  }));
  const x = logAxis(points.map((point) => point.x), 0.08, 0.08);
  const y = logAxis(points.flatMap((point) => [point.y0, point.y1, point.x]), 0.08, 0.04);
  const share = (part, text, dash) => {
    const from = Math.max(x.low, y.low * part), to = Math.min(x.high, y.high * part);
    return from < to && { color: part === 1 ? "ink" : "muted", dash, points: [[from, from / part], [to, to / part]], note: text };
  };
  const lines = [share(1, "the machine's limit"), share(2, "1/2", "2 4"), share(10, "1/10", "2 4"), share(100, "1/100", "2 4")];
  return {
    points, x, y, lines: lines.filter(Boolean), label: "frames a second against the machine's limit",
    xTitle: "frames a second at the limit that binds", yTitle: "frames a second reached",
  };
};

const startLimit = () => {
  if (!place("live-limit")) return; // the run has no calibration
  const at = figure("live-limit", "");
  const redraw = () => {
    const all = rowsOf(chosen.group).filter((row) => row.ok && !chosen.hidden.has(row.method));
    const list = all.filter((row) => allowedOf(row) !== null);
    if (list.length) chart(at.chartPlace, limitSpec(list));
    else at.chartPlace.replaceChildren(make("p.soft", null, "Of no cell that is switched on here a limit is known."));
    const unknown = all.length - list.length;
    at.below.replaceChildren(
      legend([...new Set(rowsOf(chosen.group).filter((row) => row.ok).map((row) => row.method))]),
      `${chosen.group.title}. On the line a cell does all that the machine can of the resource that binds it, named beside its point; on the line 1/10, a tenth. `,
      unknown ? `Of ${count(unknown, "cell")} no limit is known. ` : "", "A click leads to the cell.");
    at.again.replaceChildren(list.length ? redo(list) : "");
  };
  onChange(redraw);
  keepWidth(at.chartPlace, redraw);
};
