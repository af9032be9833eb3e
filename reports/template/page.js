// Starts the page: the switches, the parts, the theme, paper.
"use strict";
// ---- Light, dark, or as the system has it; remembered where the browser allows a page on disk to remember.
const startTheme = () => {
  const names = ["system", "light", "dark"], root = document.documentElement;
  let theme = "system";
  try { theme = localStorage.getItem("treeline-theme") || theme; } catch { /* not allowed: forgotten on reload */ }
  const button = make("button.chip.theme", { type: "button", click: () => apply(names[(names.indexOf(theme) + 1) % names.length]) });
  const apply = (name) => {
    theme = names.includes(name) ? name : "system";
    if (theme === "system") root.removeAttribute("data-theme");
    else root.setAttribute("data-theme", theme);
    button.textContent = `colours: ${theme}`;
    try { localStorage.setItem("treeline-theme", theme); } catch { /* as above */ }
  };
  apply(theme);
  document.querySelector("header nav").append(button);
};

// ---- One bar of switches for all charts.
const startControls = () => {
  const groupsOf = (family) => data.groups.filter((group) => group.family === family);
  const select = (name, options, pick) => {
    const list = make("select", { name, change: () => pick(Number(list.value)) });
    const fill = (texts, value) => {
      list.replaceChildren(...texts.map(([index, text]) => make("option", { value: index }, text)));
      list.value = value;
    };
    fill(options, options[0][0]);
    return { label: make("label", null, name, list), fill };
  };
  const scene = select("scene", data.families.map((title, i) => [i, title]), (family) => {
    const of = groupsOf(family);
    change({ group: of.find((group) => group.trees === chosen.group.trees) || of[of.length - 1] });
  });
  const trees = select("trees", [[0, ""]], (index) => change({ group: data.groups[index] }));
  const error = select("error", data.metrics.map((item, i) => [i, item.heading]), (index) => change({ metric: index }));
  const against = select("against", [[0, "same effects"], [1, "all effects"]], (index) => change({ effects: index ? "full" : "same" }));
  const time = select("speed", [[0, "ms a frame"], [1, "fps"]], (index) => change({ rate: index === 1 }));
  const update = () => {
    const family = chosen.group.family;
    scene.fill(data.families.map((title, i) => [i, title]), family);
    trees.fill(groupsOf(family).map((group) => [data.groups.indexOf(group), plain(group.trees, 15)]), data.groups.indexOf(chosen.group));
  };
  onChange(update);
  update();
  place("live-controls").replaceChildren(make("form.controls", { submit: (event) => event.preventDefault() },
    scene.label, trees.label, error.label, against.label, time.label));
};

// ---- The forest that the headline speaks about comes first.
chosen.group = data.groups[data.main_group];
startTheme();
startControls();
startTrade();
startSplit();
startGrowth();
startDistance();
startAngles();
startCost();
startLimit();
startCompare();
startTable();
document.documentElement.classList.add("js");
addEventListener("hashchange", openCell);
openCell();
