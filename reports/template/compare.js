// Reference and method under one slider, the FLIP map and the coverage map beside.
"use strict";
const startCompare = () => {
  const at = { row: null, view: 0, cut: 50 };
  const comparable = () => rowsOf(chosen.group).filter((row) => row.ok && !row.floor && viewsWithPictures(row).length);

  const slider = (picture, reference, row) => {
    const box = make("div.slider", { style: `--cut:${at.cut}%;aspect-ratio:${picture.getAttribute("width")}/${picture.getAttribute("height")}` },
      borrow(picture), reference ? Object.assign(borrow(reference), { className: "over" }) : "",
      make("span.tag.left", null, `reference, ${effectsText()}`), make("span.tag.right", null, row.label), make("span.cut"));
    box.append(make("input", {
      type: "range", min: 0, max: 100, step: 0.5, value: at.cut, "aria-label": "reference to the left, method to the right",
      input: (event) => { at.cut = event.target.value; box.style.setProperty("--cut", `${at.cut}%`); },
    }));
    return box;
  };
  const choice = (name, options, value, pick) => make("label", null, name, make("select", { change: (event) => pick(Number(event.target.value)) },
    options.map(([index, text]) => make("option", { value: index, selected: index === value }, text))));

  const redraw = () => {
    const list = comparable();
    if (!list.length) {
      place("live-compare").replaceChildren(make("p.soft", null, `This page holds no pictures of ${chosen.group.title}.`));
      return;
    }
    if (!list.includes(at.row)) at.row = list.find((row) => at.row && row.series === at.row.series) || list[0];
    const views = viewsWithPictures(at.row);
    if (!views.includes(at.view)) at.view = views[0];
    const picture = imageOf(at.row, at.view, "picture"), reference = referenceOf(picture, chosen.effects);
    const errors = at.row.views[at.view];
    const map = (kind, text) => {
      const image = imageOf(at.row, at.view, kind);
      return make("figure", null, image ? fullSize(image) : make("p.missing", null, "no map"), make("figcaption", null, text));
    };
    place("live-compare").replaceChildren(
      make("div.controls", null,
        choice("method", list.map((row) => [row.index, row.label]), at.row.index, (index) => { at.row = rows[index]; redraw(); }),
        choice("view", views.map((view) => [view, `${view + 1}, ${whereOf(at.row.views[view])}`]), at.view, (view) => { at.view = view; redraw(); })),
      make("div.compare", null,
        make("figure", null, slider(picture, reference, at.row),
          make("figcaption", null, `${at.row.group.title}, view ${at.view + 1}. `,
            errors.length > VIEW_ERRORS ? `${metric().heading} ${plain(errorsOfView(errors, "same"))} (same effects), ${plain(errorsOfView(errors, "full"))} (all effects). ` : "",
            reference ? "" : "This page does not hold the reference. ", linkTo(at.row))),
        make("div.compare-maps", null,
          map("flip", "FLIP map, same effects: dark is the same, bright differs"),
          map("coverage", "coverage: blue is missing, orange is too much"))));
  };
  onChange(redraw);
  redraw();
};
