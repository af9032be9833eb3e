#!/usr/bin/python3
"""The report's page in a real browser, by clicking: page_live.py CHROMIUM OUT MANY_OUT PAPERS_OUT [LOOK].

OUT holds the report of the synthetic run, MANY_OUT one of ten thousand cells,
PAPERS_OUT one with cells that a paper prints. What the page shows is compared with
OUT/tables/results.csv. Whatever the browser complains about is a failure. LOOK: a folder for
pictures of what was seen, to look at."""
import csv
import math
import os
import re
import shutil
import sys
import tempfile

from page_browser import Browser

program, out, many, papers = sys.argv[1:5]
results = []


def look(browser, name):
    if len(sys.argv) > 5:
        browser.picture(os.path.join(sys.argv[5], name + ".png"), whole=True)


def check(name, good, detail=""):
    results.append(bool(good))
    if not good:
        print(f"FAILED {name} {detail}")


def cells(folder):
    return list(csv.DictReader(open(os.path.join(folder, "tables", "results.csv"), encoding="utf-8", newline="")))


def number(text):
    return float(text) if text else None


def group(rows, scene, trees):
    return [r for r in rows if r["scene"] == scene and r["trees"] == str(trees) and r["status"] == "ok" and r["method"] != "null"]


def dots(browser, place):
    """Number of the cell and position of every point of a chart."""
    return browser.run(f"""Array.from(document.querySelectorAll("#{place} .dot"), (dot) => {{
        const at = dot.firstChild.getAttribute("transform").match(/translate\\(([-\\d.]+) ([-\\d.]+)\\)/);
        return [Number(dot.getAttribute("href").slice(6)) - 1, Number(at[1]), Number(at[2]), dot.firstChild.classList.contains("filled")]; }})""")


def is_logarithmic(places, values):
    """Pixels are an affine function of the logarithms, within a pixel's rounding."""
    pairs = sorted(zip(map(math.log, values), places))
    (x0, y0), (x1, y1) = pairs[0], pairs[-1]
    return x1 > x0 and all(abs(y0 + (y1 - y0) * (x - x0) / (x1 - x0) - y) < 0.3 for x, y in pairs)


def front(rows, cost, error):
    beaten = lambda a: any((b[cost] <= a[cost] and b[error] < a[error]) or (b[cost] < a[cost] and b[error] <= a[error]) for b in rows)
    return {r["i"] for r in rows if not beaten(r)}


def slope(xs, ys):
    lx, ly = [math.log(x) for x in xs], [math.log(y) for y in ys]
    mx, my = sum(lx) / len(lx), sum(ly) / len(ly)
    return sum((x - mx) * (y - my) for x, y in zip(lx, ly)) / sum((x - mx) ** 2 for x in lx)


def fits(browser, name):
    wide, room = browser.run("[document.documentElement.scrollWidth, document.documentElement.clientWidth]")
    check(f"{name}: the page is not wider than its window", wide <= room, f"{wide} in {room}")


def quiet(browser, name):
    check(f"{name}: the browser complains about nothing", not browser.complaints, "; ".join(browser.complaints[:3]))
    browser.complaints.clear()


def check_trade(browser, rows):
    def compare(scene, trees, key, fps=False):
        wanted = [dict(r, i=rows.index(r), cost=number(r["frame_seconds"]), error=number(r[key])) for r in group(rows, scene, trees)]
        found = dots(browser, "live-trade")
        ok = {d[0] for d in found} == {r["i"] for r in wanted}
        if ok:
            by = {d[0]: d for d in found}
            times = [1 / r["cost"] if fps else r["cost"] for r in wanted]
            ok = is_logarithmic([by[r["i"]][1] for r in wanted], times) and is_logarithmic([by[r["i"]][2] for r in wanted], [r["error"] for r in wanted])
            ok = ok and {d[0] for d in found if d[3]} == front(wanted, "cost", "error")
            rising = sorted(zip(times, (by[r["i"]][1] for r in wanted)))
            lower = sorted(zip((r["error"] for r in wanted), (-by[r["i"]][2] for r in wanted)))
            ok = ok and [p for _, p in rising] == sorted(p for _, p in rising) and [p for _, p in lower] == sorted(p for _, p in lower)
        return ok

    pick = lambda name, value: browser.choose(f"#live-controls select[name={name}]", value)
    check("the trade plot opens with the forest of the headline", compare("poplar-forest", 1000, "same_flip"))
    pick("error", "1")
    check("the error switch changes the error", compare("poplar-forest", 1000, "same_rmse"))
    pick("against", "1")
    check("the reference switch changes the reference", compare("poplar-forest", 1000, "full_rmse"))
    pick("trees", browser.run("String(data.groups.findIndex((group) => group.trees === 100))"))
    check("the switch of trees changes the cells", compare("poplar-forest", 100, "full_rmse"))
    pick("speed", "1")
    check("the speed switch shows frames a second", compare("poplar-forest", 100, "full_rmse", fps=True))
    pick("scene", "1")
    check("the scene switch changes the scene and its trees", compare("walk-in", 30, "full_rmse", fps=True))
    views = sum(1 for r in group(rows, "walk-in", 30)) * 3
    check("error against distance has a point a view", len(dots(browser, "live-distance")) == views)
    check("a camera that walks in shows no error against elevation", not dots(browser, "live-elevation"))
    for name, value in (("scene", "0"), ("speed", "0"), ("against", "0"), ("error", "0")):
        pick(name, value)
    pick("trees", browser.run("String(data.groups.findIndex((group) => group.trees === 1000))"))
    views = sum(1 for r in group(rows, "poplar-forest", 1000)) * 3
    check("error against elevation has a point a view", len(dots(browser, "live-elevation")) == views)
    check("and neither distance nor azimuth, which it keeps, a chart", not dots(browser, "live-distance") and not dots(browser, "live-azimuth"))

    before = len(dots(browser, "live-growth"))
    browser.click("#live-trade .chip")
    hidden = browser.run("Array.from(document.querySelectorAll('.dot, .bar-row a'), (a) => rows[a.getAttribute('href').slice(6) - 1].method.name)")
    check("a method that is switched off is off in every chart", hidden and "billboards" not in hidden and len(dots(browser, "live-growth")) < before)
    browser.click("#live-trade .chip")
    check("and comes back", len(dots(browser, "live-growth")) == before)


def check_hover(browser, rows):
    first = dots(browser, "live-trade")[0][0]
    browser.hover(f"#live-trade .dot[href='#cell-{first + 1}']")
    text = browser.run("document.querySelector('.hover-card').hidden ? '' : document.querySelector('.hover-card').textContent")
    fps = number(rows[first]["fps"])
    shown = re.search(r"frames a second([\d.,]+)", text)
    check("hovering shows name and figures", rows[first]["method"] in text and shown and abs(float(shown[1].replace(",", "")) / fps - 1) < 0.01, text)
    check("hovering shows the picture", browser.run("document.querySelector('.hover-card img')?.naturalWidth > 0"))
    browser.click(f"#live-trade .dot[href='#cell-{first + 1}']")
    check("a click leads to the cell", browser.run("location.hash") == f"#cell-{first + 1}" and
          rows[first]["cell"] in browser.run("document.querySelector('.sheet')?.textContent || ''"))
    check("which is in sight", browser.run("(() => { const box = document.querySelector('.sheet').getBoundingClientRect(); return box.top >= 0 && box.top < innerHeight; })()"))
    check("the card is gone", browser.run("document.querySelector('.hover-card').hidden"))
    check("the cell shows its pictures and maps", browser.run("Array.from(document.querySelectorAll('.sheet img')).filter((i) => i.naturalWidth > 0).length") >= 12)
    check("the cell shows its commands", "treeline run " in browser.run("document.querySelector('.sheet pre').textContent"))
    browser.click(".sheet .chip")
    check("and closes", browser.run("document.querySelector('.sheet') === null"))
    browser.run("document.querySelector('#live-trade .chip').focus()")
    for _ in range(8): # backwards over the points, which stand before the names
        browser.key("Tab", 9, shift=True)
        if browser.run("document.activeElement.matches('.dot')"):
            break
    check("the keyboard reaches a point", not browser.run("document.querySelector('.hover-card').hidden"))
    browser.run("document.activeElement.blur()")


def check_growth(browser, rows):
    texts = browser.run("Array.from(document.querySelectorAll('#live-growth ul.laws li'), (li) => li.textContent)")
    table = browser.run("Array.from(document.querySelectorAll('table.laws tbody tr'), (tr) => Array.from(tr.cells, (td) => td.textContent))")
    good = len(table) > 0
    for scene, name, b, interval, r2, n in table:
        label = lambda r: " ".join(filter(None, [r["method"], r["options"].replace(",", " "), "lod=" + r["lod"] if r["method"] == "polygons" else ""]))
        of = [r for r in rows if r["scene"] == scene and label(r) == name and r["status"] == "ok"]
        wanted = slope([float(r["trees"]) for r in of], [float(r["frame_seconds"]) for r in of])
        low, high = [float(part.replace("\u2212", "-")) for part in interval.split(" to ")]
        value = float(b.replace("\u2212", "-"))
        good = good and abs(value - wanted) < 0.0051 and low <= value <= high and int(n) == len(of)
        if name != "null":
            good = good and any(t.startswith(name) and f"N^{b}" in t for t in texts)
    check("the growth laws are Python's slopes", good, str(table)[:300])


def check_limit(browser, rows):
    def compare(wanted):
        found = {d[0]: d for d in dots(browser, "live-limit")}
        if set(found) != {rows.index(r) for r in wanted}:
            return False
        reached = [1 / number(r["frame_seconds"]) for r in wanted]
        allowed = [f / number(r["limit_fraction"]) for f, r in zip(reached, wanted)]
        at = [found[rows.index(r)] for r in wanted]
        rising = lambda values, places: [p for _, p in sorted(zip(values, places))] == sorted(places)
        return (is_logarithmic([d[1] for d in at], allowed) and is_logarithmic([d[2] for d in at], reached)
                and rising(allowed, [d[1] for d in at]) and rising([-v for v in reached], [d[2] for d in at]))

    drawn = [r for r in rows if r["scene"] == "poplar-forest" and r["trees"] == "1000" and r["limit_fraction"]]
    check("every cell with a limit stands on the chart of limits", len(drawn) > 3 and compare(drawn), [len(drawn)])
    check("two resources bind them", {r["bound_by"] for r in drawn} == {"fill", "samples"})
    notes = browser.run("Array.from(document.querySelectorAll('#live-limit text.note'), (text) => text.textContent)")
    check("the line and its shares are named", {"the machine's limit", "1/2", "1/10"} <= set(notes), notes)
    check("and a point by what binds it", {"fill", "samples"} <= set(notes), notes)
    name = "billboards"
    chip = f"Array.from(document.querySelectorAll('#live-limit .chip')).find((chip) => chip.textContent.includes('{name}')).click()"
    browser.run(chip)
    check("a name switches its method off there", compare([r for r in drawn if r["method"] != name]))
    browser.run(chip)
    check("and on again", compare(drawn))
    first = dots(browser, "live-limit")[0][0]
    browser.middle(f"#live-limit .dot[href='#cell-{first + 1}']") # the scroll, which hides a card
    browser.settle()
    browser.hover(f"#live-limit .dot[href='#cell-{first + 1}']")
    card = browser.run("document.querySelector('.hover-card').textContent")
    check("hovering tells the limit", rows[first]["bound_by"] in card, card)
    browser.click(f"#live-limit .dot[href='#cell-{first + 1}']")
    check("a click on it leads to the cell", browser.run("location.hash") == f"#cell-{first + 1}")
    browser.click(".sheet .chip")


def check_bars(browser, rows):
    of = {rows.index(r): r for r in group(rows, "poplar-forest", 1000)}
    found = browser.run("""Array.from(document.querySelectorAll("#live-split .bar-row"), (row) => [Number(row.querySelector("a").getAttribute("href").slice(6)) - 1,
        ...Array.from(row.querySelectorAll(".bar-track span"), (part) => part.getBoundingClientRect().width)])""")
    same = {i: number(r["same_flip"]) for i, r in of.items()}
    full = {i: number(r["full_flip"]) for i, r in of.items()}
    good = {f[0] for f in found} == set(of)
    scale = max(f[1] + f[2] for f in found) / max(full.values())
    good = good and all(abs(f[1] - scale * same[f[0]]) < 1.5 and abs(f[2] - scale * max(0, full[f[0]] - same[f[0]])) < 1.5 for f in found)
    check("the bars split the error into representation and the rest", good, str(found))
    check("memory and build time stand beside", browser.run("document.querySelectorAll('#live-cost .bar-row').length") == 2 * len(of))


def check_slider(browser):
    browser.choose("#live-compare select", browser.run("document.querySelector('#live-compare option:nth-child(2)').value"))
    x, y = browser.middle(".slider")
    width = browser.run("document.querySelector('.slider').getBoundingClientRect().width")
    browser.drag((x, y), (x - 0.3 * width, y))
    cut = browser.run("parseFloat(getComputedStyle(document.querySelector('.slider')).getPropertyValue('--cut'))")
    check("the slider follows the pointer", 15 < cut < 25, cut)
    clip = browser.run("getComputedStyle(document.querySelector('.slider .over')).clipPath")
    check("and cuts the reference there", "80" in clip or "calc" in clip or re.search(r"7\d\.|8\d\.", clip), clip)
    sizes = browser.run("Array.from(document.querySelectorAll('.compare img'), (image) => image.naturalWidth)")
    check("two pictures and two maps stand there", len(sizes) == 4 and all(sizes), sizes)
    sources = browser.run("Array.from(document.querySelectorAll('.slider img'), (image) => image.src.length + image.src.slice(-400))")
    check("reference and method are two pictures", len(set(sources)) == 2)
    browser.choose("#live-controls select[name=against]", "1")
    other = browser.run("document.querySelector('.slider .over').src.slice(-400)")
    check("the other reference comes with its switch", not sources[1].endswith(other))
    browser.choose("#live-controls select[name=against]", "0")


def check_table(browser, rows):
    column = lambda n: browser.run(f"Array.from(document.querySelector('table.results').tBodies[0].rows, (row) => row.cells[{n}].dataset.v ?? row.cells[{n}].textContent)")
    names = lambda: browser.run("Array.from(document.querySelectorAll('table.results tbody a.cell'), (a) => Number(a.getAttribute('href').slice(6)) - 1)")
    heads = browser.run("document.querySelector('table.results').tHead.rows[0].cells.length")
    good = True
    for n in range(heads):
        for direction in ("ascending", "descending"):
            browser.run(f"document.querySelector('table.results').tHead.rows[0].cells[{n}].querySelector('button').click()")
            state = browser.run(f"document.querySelector('table.results').tHead.rows[0].cells[{n}].getAttribute('aria-sort')")
            values = column(n)
            if n not in (0, 2):
                tail = [v for v in values if v != ""]
                values = [float(v) for v in tail] if values[:len(tail)] == tail else [1, 0, 1]
            good = good and state == direction and values == sorted(values, reverse=direction == "descending") and sorted(names()) == list(range(len(rows)))
    check("every column sorts both ways, loses no cell, and keeps missing values last", good)
    check("one heading alone is marked as sorted", browser.run("document.querySelectorAll('[aria-sort]').length") == 1)
    browser.type("#live-filter input[type=search]", "walk-in polygons")
    wanted = {i for i, r in enumerate(rows) if r["scene"] == "walk-in" and r["method"] == "polygons"}
    check("words filter", set(names()) == wanted and browser.run("document.querySelector('#live-filter [role=status]').textContent").startswith(f"{len(wanted)} of {len(rows)}"))
    browser.choose("#live-filter input[type=search]", "")
    browser.click("#live-filter label input")
    check("the front alone can be asked for", set(names()) == {i for i, r in enumerate(rows) if r["on_front"] == "1"})
    browser.click("#live-filter label input")
    browser.click("#live-filter label + label input")
    check("failures alone too", set(names()) == {i for i, r in enumerate(rows) if float(r["failures"]) > 0})
    browser.click("#live-filter label + label input")
    browser.choose("#live-filter select[aria-label=method]", "2")
    methods = sorted({r["method"] for r in rows})
    check("and one method", set(names()) == {i for i, r in enumerate(rows) if r["method"] == methods[2]})
    browser.choose("#live-filter select[aria-label=method]", "")
    browser.click("table.results tbody a.cell")
    check("a name leads to its cell", browser.run("document.querySelector('.sheet').id") == browser.run("location.hash.slice(1)"))


def check_theme(browser, page):
    color = lambda: browser.run("getComputedStyle(document.body).backgroundColor")
    light = color()
    browser.media("dark")
    dark = color()
    check("the page follows the system's colours", light != dark)
    # contrast of text and of every method's colour against the ground, WCAG 2
    script = """(() => { const part = (v) => (v /= 255) <= .03928 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4;
        const light = (c) => { const [r, g, b] = c.match(/[\\d.]+/g).map(Number); return .2126 * part(r) + .7152 * part(g) + .0722 * part(b); };
        const ratio = (a, b) => (Math.max(a, b) + .05) / (Math.min(a, b) + .05);
        const ground = light(getComputedStyle(document.body).backgroundColor), probe = document.createElement("i"); document.body.append(probe);
        const of = (name) => { probe.style.color = `var(--${name})`; return ratio(light(getComputedStyle(probe).color), ground); };
        const found = [of("ink"), of("muted"), ...data.methods.map((m) => of(m.color))]; probe.remove(); return found; })()"""
    for scheme in ("dark", "light"):
        browser.media(scheme)
        ink, muted, *methods = browser.run(script)
        check(f"{scheme}: text and colours stand out", ink >= 7 and muted >= 4.5 and min(methods) >= 3, [ink, muted, methods])
    browser.media("light")
    seen = []
    for _ in range(3):
        browser.click("button.theme")
        seen.append((browser.run("document.documentElement.dataset.theme || 'system'"), color()))
    check("the switch goes through light, dark and the system's", seen == [("light", light), ("dark", dark), ("system", light)], seen)
    browser.click("button.theme")
    browser.click("button.theme")
    browser.open(page)
    browser.settle()
    check("the choice is remembered", browser.run("document.documentElement.dataset.theme") == "dark" and color() == dark)
    browser.click("button.theme")


def check_paper(browser):
    browser.media("dark", "print")
    shown = lambda what: browser.run(f"Array.from(document.querySelectorAll('{what}')).filter((node) => node.getClientRects().length).length")
    check("on paper the static plots stand in for the live ones", shown("svg.plot") >= 6 and shown("svg.chart") == 0, [shown("svg.plot"), shown("svg.chart")])
    check("paper is light", browser.run("getComputedStyle(document.documentElement).colorScheme") == "light")
    paper = browser.paper()
    sizes = {tuple(map(float, box.split())) for box in re.findall(r"/MediaBox *\[ *([\d. ]+)\]", paper.decode("latin-1"))}
    check("wide tables get sheets across", {width > height for _, _, width, height in sizes} == {True, False}, sizes)
    browser.media("light")


def check_small(browser, page):
    browser.size(360, 780, touch=True)
    for scheme in ("light", "dark"):
        browser.media(scheme)
        browser.open(page)
        browser.settle()
        look(browser, f"narrow-{scheme}")
        fits(browser, f"360 px, {scheme}")
        browser.run("for (const section of document.querySelectorAll('details')) section.open = true")
        browser.settle()
        fits(browser, f"360 px, {scheme}, everything open")
    browser.media("light")
    browser.tap("#live-trade .dot")
    check("a tap shows the card with a link", browser.run("!!document.querySelector('.hover-card:not([hidden]) a')"))
    browser.tap(".hover-card a")
    check("which leads to the cell", browser.run("document.querySelector('.sheet')?.id === location.hash.slice(1)"))
    fits(browser, "360 px, a cell open")
    broken = browser.run("""Promise.all(Array.from(document.images, (image) => image.decode().then(() => "", () => image.alt))).then((all) => all.filter(Boolean).concat(all.length > 60 ? [] : ["few"]))""")
    check("every picture decodes", broken == [], broken)
    browser.size(1280)


def check_without_script(browser, page, rows):
    browser.scripts(False)
    browser.open(page)
    browser.scripts(True) # the page's own script did not run; ours may look
    shown = lambda what: browser.run(f"Array.from(document.querySelectorAll('{what}')).filter((node) => node.getClientRects().length).length")
    check("without script the static plots are there", shown("svg.plot") >= 6 and shown(".live") == 0)
    check("and every cell has its row and anchor", shown("table.results tbody tr") == len(rows) and shown("[id^=cell-]") == len(rows))
    check("and the table of memory and build time", shown("table.cost") == 1)
    fits(browser, "without script")


def check_many(browser, folder):
    rows = cells(folder)
    browser.open(os.path.join(folder, "index.html"))
    browser.settle()
    check("ten thousand cells are there", len(rows) == 10000 == browser.run("rows.length"))
    elements = browser.run("document.getElementsByTagName('*').length")
    check("but few elements (every cell in the table would be 300,000)", elements < 31000, elements)
    shown = lambda: browser.run("Array.from(document.querySelectorAll('table.results tbody a.cell'), (a) => Number(a.getAttribute('href').slice(6)) - 1)")
    check("a part of the table is shown", len(shown()) == 200)
    browser.run("document.querySelector('table.results').tHead.rows[0].cells[3].querySelector('button').click()")
    times = sorted(number(r["frame_seconds"]) for r in rows if r["frame_seconds"])
    # the page's numbers have five digits
    are = lambda wanted: len(shown()) == len(wanted) and all(abs(number(rows[i]["frame_seconds"]) / w - 1) < 1e-4 for i, w in zip(shown(), wanted))
    check("which is the right one after sorting", are(times[:200]))
    browser.click("#live-more button")
    check("more of it can be had", are(times[:700]))
    browser.type("#live-filter input[type=search]", "scene-007 polygons")
    wanted = {i for i, r in enumerate(rows) if "scene-007" in r["scene"] and r["method"] == "polygons"}
    check("and filtered", set(shown()) == wanted and wanted)
    plots = [name for name in os.listdir(os.path.join(folder, "plots")) if name.endswith(".gp")]
    check("few plots were drawn beforehand", 0 < len(plots) <= 25, len(plots))
    fits(browser, "ten thousand cells")
    quiet(browser, "ten thousand cells")


def check_papers(browser, folder):
    rows = list(csv.DictReader(open(os.path.join(folder, "tables", "papers.csv"), encoding="utf-8", newline="")))
    page = os.path.join(folder, "index.html")
    browser.open(page)
    browser.settle()
    look(browser, "papers")
    shown = browser.run("""Array.from(document.querySelectorAll("#papers ~ .scroll > table.paper"), (table) => Array.from(table.tBodies[0].rows, (row) =>
        Array.from(row.cells, (cell) => cell.firstChild ? cell.firstChild.textContent : "")))""")
    claims, lines = shown[0], [line for table in shown[1:] for line in table]
    check("the papers' tables have a line a printed row", len(lines) == len(rows) > 30, [len(lines), len(rows)])
    near = lambda text, value: text == "\u2013" if value == "" else abs(float(text.replace(",", "")) / float(value) - 1) < 6e-3
    check("with its ratio and ours", all(near(l[5], r["printed_ratio"]) and near(l[6], r["ratio"]) for l, r in zip(lines, rows)))
    check("what failed or was not run is said", [l[4] for l, r in zip(lines, rows) if r["state"] != "ok"] == [r["state"] for r in rows if r["state"] != "ok"] == ["not measured", "timeout"])
    verdicts = [word for row in claims for word in row if word in ("holds", "does not hold", "open", "not measured")]
    check("every finding has a verdict", len(verdicts) == len(claims) and len(set(verdicts)) == 4, verdicts)
    check("the plot of ratios stays beside the script", browser.run("document.querySelector('#papers ~ div svg.plot').getClientRects().length") == 1)
    check("the papers are in the contents", browser.run("document.querySelectorAll('nav a[href=\"#papers\"]').length") == 1)
    for width, scheme in ((1280, "light"), (360, "light"), (360, "dark")):
        browser.size(width, touch=width < 500)
        browser.media(scheme)
        browser.open(page)
        browser.settle()
        look(browser, f"papers-{width}-{scheme}")
        fits(browser, f"papers, {width} px, {scheme}")
    browser.size(1280)
    browser.media("light")
    quiet(browser, "papers")
    browser.open(os.path.join(out, "index.html"))
    check("a run without a printed cell has no such section", browser.run("document.getElementById('papers')") is None)


def check_alone(browser, page):
    folder = tempfile.mkdtemp()
    shutil.copy(page, os.path.join(folder, "alone.html"))
    browser.open(os.path.join(folder, "alone.html"), "#cell-5")
    browser.settle()
    check("a link to a cell opens it, and the file needs no other", browser.run("document.querySelector('.sheet')?.id") == "cell-5")
    quiet(browser, "alone")
    shutil.rmtree(folder)


def main():
    page, rows = os.path.join(out, "index.html"), cells(out)
    browser = Browser(program)
    try:
        browser.size(1280)
        browser.media("light")
        browser.open(page)
        browser.settle()
        check("the script ran to its end", browser.run("document.documentElement.classList.contains('js')"))
        look(browser, "wide")
        fits(browser, "1280 px")
        check_trade(browser, rows)
        check_hover(browser, rows)
        check_growth(browser, rows)
        check_limit(browser, rows)
        check_bars(browser, rows)
        check_slider(browser)
        check_table(browser, rows)
        fits(browser, "1280 px, after all that")
        check_theme(browser, page)
        check_paper(browser)
        check_small(browser, page)
        quiet(browser, "the page")
        check_without_script(browser, page, rows)
        check_alone(browser, page)
        check_many(browser, many)
        check_papers(browser, papers)
    finally:
        browser.close()


try:
    main()
except Exception as error:
    check("the check came to its end", False, repr(error))
print(f"{sum(results)} passed, {len(results) - sum(results)} failed, 0 skipped")
sys.exit(0 if all(results) else 1)
