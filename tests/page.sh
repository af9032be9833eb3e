#!/usr/bin/env bash
# The report's page in a real browser: its script runs, its table sorts, nothing complains, nothing overflows.
# tests/page.sh; needs chromium, skips without.
set -u
cd "$(dirname "$0")/.." || exit 1
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
  echo "0 passed, 0 failed, 1 skipped"
  exit 0
}
make -s build/release-gcc/tests/test_report all || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OMP_WAIT_POLICY=passive TREELINE_DATA="${TREELINE_DATA:-$PWD}"
build/release-gcc/tests/test_report page "$work/run" "$work/out" || exit 1

# The check goes into a copy of the page: errors are caught from the first line on, the findings are posted to the
# page around it, whose frame may be narrower than the browser's smallest window.
cat >"$work/first.html" <<'HTML'
<script>
window.complaints = [];
window.addEventListener("error", (event) => complaints.push("error: " + event.message));
for (const kind of ["error", "warn"]) console[kind] = (...words) => complaints.push(kind + ": " + words.join(" "));
</script>
HTML
cat >"$work/last.html" <<'HTML'
<script>
window.addEventListener("load", () => {
  const results = [];
  const check = (name, good, detail = "") => results.push((good ? "ok " : "FAILED ") + name + " " + detail);
  const table = document.querySelector("table.results"), body = table.tBodies[0];
  const rowsBefore = Array.from(body.rows, (row) => row.textContent).sort().join();
  const numbers = (column) => Array.from(body.rows, (row) => row.cells[column].dataset.v);
  const ordered = (column, sign) => {
    const texts = numbers(column), values = texts.filter((text) => text !== "").map(Number);
    const tail = texts.slice(values.length).every((text) => text === "");
    return tail && values.every((value, i) => i === 0 || sign * (value - values[i - 1]) >= 0);
  };
  let sorted = true;
  const heads = table.tHead.rows[0].cells;
  for (let column = 0; column < heads.length; column++) {
    if (numbers(column)[0] === undefined) continue;
    heads[column].querySelector("button").click();
    const up = heads[column].getAttribute("aria-sort") === "ascending" && ordered(column, 1);
    heads[column].querySelector("button").click();
    const down = heads[column].getAttribute("aria-sort") === "descending" && ordered(column, -1);
    if (!up || !down) sorted = false;
  }
  check("every column of numbers sorts both ways, missing values last", sorted);
  heads[2].querySelector("button").click();
  const labels = Array.from(body.rows, (row) => row.cells[2].textContent.trim());
  check("the column of methods sorts as text", labels.every((text, i) => i === 0 || labels[i - 1] <= text));
  check("sorting loses no row", rowsBefore === Array.from(body.rows, (row) => row.textContent).sort().join());
  check("one heading alone is marked as sorted", table.querySelectorAll("[aria-sort]").length === 1);
  for (const section of document.querySelectorAll("details")) section.open = true;
  const images = Array.from(document.images);
  Promise.all(images.map((image) => image.decode().catch(() => complaints.push("picture: " + image.alt)))).then(() => {
    check("every picture decodes", images.length > 20 && images.every((image) => image.naturalWidth > 0), images.length);
    const wide = document.documentElement.scrollWidth, room = document.documentElement.clientWidth;
    check("the page is not wider than its window", wide <= room && room <= 1280, wide + " in " + room);
    const plots = Array.from(document.querySelectorAll("svg.plot")).filter((plot) => plot.getBoundingClientRect().width > 0);
    check("one version of each plot is seen", plots.length === document.querySelectorAll("svg.plot").length / 2, plots.length);
    check("no complaint", complaints.length === 0, complaints.join("; "));
    parent.postMessage(results.join("\n"), "*");
  });
});
</script>
HTML
sed -e "/<meta charset/r $work/first.html" "$work/out/index.html" | sed -e "/^<\/body>/{
r $work/last.html
N
}" >"$work/out/checked.html"

passed=0 failed=0
for width in 1280 360; do
  cat >"$work/out/around.html" <<HTML
<!DOCTYPE html><html><body><iframe src="checked.html" width="$width" height="900" style="border:0"></iframe>
<script>
window.addEventListener("message", (event) => { document.documentElement.dataset.check = event.data; });
</script></body></html>
HTML
  "$browser" --headless --no-sandbox --disable-gpu --window-size=1300,900 --virtual-time-budget=20000 --dump-dom \
    "file://$work/out/around.html" 2>/dev/null |
    python3 -c '
import html.parser, sys
class P(html.parser.HTMLParser):
    def handle_starttag(self, tag, attrs):
        if tag == "html": print(dict(attrs).get("data-check", "FAILED the check never ended"))
P().feed(sys.stdin.read())' >"$work/found"
  [ -s "$work/found" ] || echo "FAILED the browser said nothing" >"$work/found"
  passed=$((passed + $(grep -c '^ok ' "$work/found")))
  failed=$((failed + $(grep -c '^FAILED ' "$work/found")))
  grep '^FAILED ' "$work/found" | sed "s/^/$width px: /"
done
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
