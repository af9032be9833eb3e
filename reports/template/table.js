// The table of all cells: sorts, filters, and shows a part at a time, so that ten thousand cells stay quick.
"use strict";
const startTable = () => {
  const table = document.querySelector("table.results"), body = table.tBodies[0];
  const heads = Array.from(table.tHead.rows[0].cells), first = 200, step = 500;
  const collator = new Intl.Collator("en", { numeric: true });
  const state = { column: -1, down: false, limit: first, list: rows };
  const keys = [(row) => data.families[row.group.family], (row) => row.group.trees, (row) => row.label,
    ...data.shown.map((shown) => (row) => data.columns[shown.column].values[row.index] ?? null)];

  // Cells without a value stay at the end, whichever way the column is sorted.
  const sorted = (list) => {
    if (state.column < 0) return list;
    const sign = state.down ? -1 : 1, keyed = list.map((row) => ({ row, key: keys[state.column](row) }));
    keyed.sort((a, b) => {
      if (a.key === null || b.key === null) return (a.key === null) - (b.key === null);
      return sign * (typeof a.key === "number" ? a.key - b.key : collator.compare(a.key, b.key));
    });
    return keyed.map((item) => item.row);
  };

  const numberCell = (row, shown) => {
    const raw = data.columns[shown.column].values[row.index] ?? null, value = raw === null ? null : raw * shown.scale;
    const isTime = data.columns[shown.column].key === "frame_seconds";
    const at = (key) => plain(valueOf(row, key) * shown.scale);
    return make("td.n", { "data-v": raw === null ? "" : value },
      isTime && !row.ok ? make("span.bad", null, row.state) : short(value),
      isTime && row.ok ? make("span.range", null, `${at("frame_seconds_low")} to ${at("frame_seconds_high")}`) : "",
      data.columns[shown.column].key === "limit_fraction" && row.bound ? make("span.range", null, row.bound) : "");
  };
  const fronts = new Set(data.front);
  const line = (row) => make(row.ok ? (fronts.has(row.index) ? "tr.front" : "tr") : "tr.failed", null,
    make("td.scene", null, data.families[row.group.family]), make("td.n", { "data-v": row.group.trees }, plain(row.group.trees, 15)),
    make("td", null, linkTo(row)), data.shown.map((shown) => numberCell(row, shown)));

  // ---- Filters.
  const words = make("input", { type: "search", placeholder: "filter, e.g. billboards 1000", "aria-label": "filter by words" });
  const select = (name, texts) => make("select", { "aria-label": name }, make("option", { value: "" }, `every ${name}`),
    texts.map((text, i) => make("option", { value: i }, text)));
  const scene = select("scene", data.families), method = select("method", data.methods.map((item) => item.name));
  const box = (text) => make("label", null, make("input", { type: "checkbox" }), text);
  const onlyFront = box("front only"), onlyFailed = box("failed only"), told = make("span.soft", { role: "status" });
  const checked = (label) => label.firstChild.checked;
  const texts = rows.map((row) => `${row.name} ${row.group.title} ${row.label} ${row.state}`.toLowerCase());
  const filter = () => {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    state.list = rows.filter((row) => wanted.every((word) => texts[row.index].includes(word)) &&
      (scene.value === "" || row.group.family === Number(scene.value)) &&
      (method.value === "" || row.method === data.methods[method.value]) &&
      (!checked(onlyFront) || fronts.has(row.index)) && (!checked(onlyFailed) || valueOf(row, "failures") > 0));
    state.limit = first;
    show();
  };

  const more = place("live-more");
  const show = () => {
    const list = sorted(state.list), part = list.slice(0, state.limit);
    body.replaceChildren(...part.map(line));
    told.textContent = `${plain(state.list.length, 15)} of ${count(rows.length, "cell")}`;
    const left = list.length - part.length;
    more.replaceChildren(left > 0 ? make("button.chip", { type: "button", click: () => { state.limit += step; show(); } },
      `show ${Math.min(step, left)} more of ${plain(left, 15)}`) : "");
  };

  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    state.down = head.getAttribute("aria-sort") === "ascending";
    state.column = column;
    for (const other of heads) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", state.down ? "descending" : "ascending");
    show();
  }));
  const form = make("form.controls", { submit: (event) => event.preventDefault(), input: filter }, words,
    data.families.length > 1 ? scene : "", data.methods.length > 1 ? method : "", onlyFront, onlyFailed, told);
  place("live-filter").replaceChildren(form);
  show();
};
