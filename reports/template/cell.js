// One cell: its pictures, the card at the pointer, and the sheet with all that is known of it, at #cell-N.
"use strict";
// Pictures stand in the gallery once; everything else borrows them. A twin has the picture of another cell.
const imageOf = (row, view, kind) => {
  const twin = document.querySelector(`.twin[data-row="${row.index}"][data-view="${view}"]`);
  const index = twin ? twin.dataset.as : row.index;
  return document.querySelector(`img[data-row="${index}"][data-view="${view}"][data-kind="${kind}"]`);
};
const referenceOf = (image, effects) => image && document.querySelector(`img[data-key="${image.dataset[effects]}"]`);
const viewsWithPictures = (row) => row.views.map((_, view) => view).filter((view) => imageOf(row, view, "picture"));
const borrow = (image) => image && make("img", { src: image.src, alt: image.alt, width: image.getAttribute("width"), height: image.getAttribute("height") });
const fullSize = (image) => image && make("a", { href: image.parentElement.getAttribute("href") }, borrow(image));

const megabytes = (bytes) => (bytes === null ? none : `${plain(bytes / 1e6)} MB`);
const figures = (row) => [
  ["time a frame", `${seconds(valueOf(row, "frame_seconds"))}`],
  ["95 % interval", `${seconds(valueOf(row, "frame_seconds_low"))} to ${seconds(valueOf(row, "frame_seconds_high"))}`],
  ["frames a second", plain(valueOf(row, "fps"))],
  [`${metric().heading}, same effects`, plain(errorOf(row, "same"))],
  [`${metric().heading}, all effects`, plain(errorOf(row, "full"))],
  ...(row.bound ? [["of the machine's limit", `${plain(100 * valueOf(row, "limit_fraction"))} % of ${row.bound}`]] : []),
  ["method's memory", megabytes(valueOf(row, "host_bytes"))],
  ["GL objects", megabytes(valueOf(row, "device_bytes"))],
];
const pairs = (list) => list.map(([name, text]) => [make("dt", null, name), make("dd", null, text)]);

// ---- The card. With a link in it when a finger called it.
const card = make("div.hover-card", { role: "status", hidden: true });
document.body.append(card);
const showCard = (row, x, y, withLink = false) => {
  if (card.dataset.row !== String(row.index) || card.hidden || withLink) {
    card.dataset.row = row.index;
    const view = viewsWithPictures(row)[0];
    card.replaceChildren(
      make("p.card-name", null, markOf(row.method), row.label),
      make("p.soft", null, row.group.title),
      make("dl", null, ...pairs(figures(row)).flat()),
      view === undefined ? "" : borrow(imageOf(row, view, "picture")),
      withLink ? make("p", null, make("a", { href: `#cell-${row.index + 1}`, click: hideCard }, "all about this cell")) : "");
    card.classList.toggle("touchable", withLink);
    card.hidden = false;
  }
  const box = card.getBoundingClientRect(), room = document.documentElement.clientWidth;
  const left = x + 18 + box.width > room - 6 ? x - 18 - box.width : x + 18;
  card.style.left = `${Math.max(6, Math.min(left, room - box.width - 6))}px`;
  card.style.top = `${Math.max(6, Math.min(y - box.height / 2, innerHeight - box.height - 6))}px`;
};
function hideCard() {
  card.hidden = true;
}
addEventListener("pointerdown", (event) => { if (!card.contains(event.target)) hideCard(); });
// A scroll takes the card away, except from the keyboard: its point stays where the reader is.
const dotOf = (node) => (node && node.matches(".dot:focus-visible") ? node : null);
const showCardOf = (dot) => {
  const box = dot.getBoundingClientRect();
  showCard(rows[Number(dot.getAttribute("href").slice("#cell-".length)) - 1], box.right, box.top);
};
addEventListener("scroll", () => (dotOf(document.activeElement) ? showCardOf(document.activeElement) : hideCard()), { passive: true });

// ---- The sheet.
const goTo = (row) => {
  const hash = `#cell-${row.index + 1}`;
  if (location.hash === hash) openCell();
  else location.hash = hash;
};

const numbersOf = (row) => data.columns
  .filter((column) => (column.values[row.index] ?? null) !== null)
  .map((column) => make("tr", null, make("td", null, make("code", null, column.key)),
    make("td.n", null, short(column.values[row.index], 4)), make("td", null, column.unit), make("td.soft", null, column.doc)));

const picturesOf = (row) => viewsWithPictures(row).map((view) => {
  const picture = imageOf(row, view, "picture");
  const shown = [["reference, same effects", referenceOf(picture, "same")],
    picture.dataset.same !== picture.dataset.full && ["reference, all effects", referenceOf(picture, "full")],
    [row.label, picture], ["FLIP map", imageOf(row, view, "flip")], ["coverage map", imageOf(row, view, "coverage")]];
  return [make("h4", null, `view ${view + 1} `, make("span.soft", null, `at ${plain(row.views[view][0])} of the path, ${whereOf(row.views[view])}`)),
    make("div.cards", null, shown.filter((item) => item && item[1]).map(([name, image]) =>
      make("figure.card", null, make("figcaption", null, name), fullSize(image))))];
});

const sheetOf = (row) => [
  make("div.sheet-head", null, make("h3", null, markOf(row.method), row.label, " ", make("span.soft", null, row.group.title)),
    make("button.chip", { type: "button", click: closeCell }, "close")),
  row.ok ? make("dl.facts", null, pairs(figures(row)).map((pair) => make("div", null, pair)))
    : make("p.notice", null, `${row.state}: ${row.message || "no message"}`),
  row.ok && row.message ? make("p.soft", null, row.message) : "",
  ...picturesOf(row).flat(),
  make("h4", null, "Again"),
  make("pre", null, [`./treeline run ${settings}--cell ${quoted(row.name)}`,
    ...row.views.slice(0, 1).map((view) => `./treeline render ${quoted(row.name)} --time ${view[0]} -o picture.png`),
    ...row.views.slice(0, 1).map((view) => `./treeline reference ${quoted(row.name)} --time ${view[0]} -o reference.exr`)].join("\n")),
  make("details", null, make("summary", null, "Every number"),
    make("div.inside", null, make("table", null, make("tbody", null, numbersOf(row))))),
];

const closeCell = () => {
  place("live-cell").replaceChildren();
  history.replaceState(null, "", "#results");
};
const openCell = () => {
  const found = /^#cell-(\d+)$/.exec(location.hash), row = found && rows[Number(found[1]) - 1];
  if (!row) return;
  hideCard();
  const sheet = make("section.sheet", { id: `cell-${row.index + 1}`, tabindex: "-1", "aria-label": row.label }, sheetOf(row));
  place("live-cell").replaceChildren(sheet);
  sheet.scrollIntoView({ behavior: "instant" });
  sheet.focus({ preventScroll: true });
};
