// Sorting of the results table; closed sections open for print.
"use strict";
(function () {
  const table = document.querySelector("table.results");
  const collator = new Intl.Collator(undefined, { numeric: true });
  const keyOf = (row, column) => {
    const cell = row.cells[column];
    if (!cell.hasAttribute("data-v")) return cell.textContent.trim();
    const text = cell.getAttribute("data-v");
    return text === "" ? null : Number(text);
  };
  const compare = (a, b) => (typeof a === "number" ? a - b : collator.compare(a, b));
  // Cells without a value stay at the end, whichever way the column is sorted.
  const sortBy = (column, down) => {
    const body = table.tBodies[0];
    const rows = Array.from(body.rows, (row) => ({ row, key: keyOf(row, column) }));
    rows.sort((a, b) => {
      if (a.key === null || b.key === null) return (a.key === null) - (b.key === null);
      return down ? compare(b.key, a.key) : compare(a.key, b.key);
    });
    body.append(...rows.map((item) => item.row));
  };
  if (table)
    for (const head of table.tHead.rows[0].cells)
      head.querySelector("button").addEventListener("click", () => {
        const down = head.getAttribute("aria-sort") === "ascending";
        for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", down ? "descending" : "ascending");
        sortBy(head.cellIndex, down);
      });
  let closed = [];
  window.addEventListener("beforeprint", () => {
    closed = Array.from(document.querySelectorAll("details.plots:not([open])"));
    for (const section of closed) section.open = true;
  });
  window.addEventListener("afterprint", () => {
    for (const section of closed) section.open = false;
  });
})();
