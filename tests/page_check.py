#!/usr/bin/env python3
"""Checks a report's files from outside: page_check.py OUT_FOLDER. Prints one line a finding; exit code 1 if any."""
import csv
import html.parser
import os
import re
import sys
import xml.etree.ElementTree

VOID = {"meta", "link", "img", "br", "hr", "input"}
out = sys.argv[1]
found = []


class Page(html.parser.HTMLParser):
    """Tags must nest; ids must be unique; links must lead somewhere; nothing may come from outside."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links, self.words = [], set(), [], []

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name == "id":
                if value in self.ids:
                    found.append(f"id {value} occurs twice")
                self.ids.add(value)
            if name in ("href", "src", "xlink:href") and not value.startswith("data:"):
                self.links.append(value)
        if tag == "img" and not dict(attrs).get("alt"):
            found.append("an image without alt text")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            found.append(f"line {self.getpos()[0]}: </{tag}> closes nothing")

    def handle_data(self, data):
        if not (self.open and self.open[-1] in ("style", "script")):
            self.words.append(data)


text = open(os.path.join(out, "index.html"), encoding="utf-8").read()
page = Page()
page.feed(text)
page.close()
if page.open:
    found.append(f"never closed: {page.open}")
for link in page.links:
    if link.startswith("#"):
        if link[1:] not in page.ids:
            found.append(f"link to nowhere: {link}")
    elif "//" in link or not os.path.exists(os.path.join(out, link)):
        found.append(f"not beside the page: {link}")
if re.search(r"url\((?!#|data:)", text) or "@import" in text:
    found.append("a style from outside")
if re.search(r"(?<![\w-])-?(nan|inf)(?![\w-])", " ".join(page.words), re.IGNORECASE):
    found.append("the page shows a NaN or an infinity")
if one := re.search(r"(?<![\w.,])1 (trees|cells|views|cores|rounds|pictures)\b", " ".join(page.words)):
    found.append(f"'{one.group()}'")
if one := re.search(r'data-unit=" tree">(?!1<)|data-unit=" trees">1<', text):
    found.append(f"a wrong plural: {one.group()}")

plots = os.path.join(out, "plots")
for name in sorted(os.listdir(plots)) if os.path.isdir(plots) else []:
    path = os.path.join(plots, name)
    if name.endswith(".svg"):
        root = xml.etree.ElementTree.parse(path).getroot()
        if not root.tag.endswith("}svg") or "viewBox" not in root.attrib:
            found.append(f"{name}: not an SVG with a viewBox")
        if re.search(r"rgb\(|['\"](black|white)['\"]", open(path, encoding="utf-8").read()):
            found.append(f"{name}: a colour that does not follow the theme")
    elif name.endswith(".png"):
        if open(path, "rb").read(8) != b"\x89PNG\r\n\x1a\n":
            found.append(f"{name}: not a PNG")

tables = os.path.join(out, "tables")
rows = list(csv.reader(open(os.path.join(tables, "results.csv"), encoding="utf-8", newline="")))
if len({len(row) for row in rows}) != 1:
    found.append("results.csv: rows of different lengths")
for row in rows:
    for value in row:
        if value.lower() in ("nan", "-nan", "inf", "-inf"):
            found.append(f"results.csv: {value}")
markdown = open(os.path.join(tables, "results.md"), encoding="utf-8").read().splitlines()
if len({len(re.findall(r"(?<!\\)\|", line)) for line in markdown}) != 1 or len(markdown) != len(rows) + 1:
    found.append("results.md: not one table with a row a cell")
latex = open(os.path.join(tables, "results.tex"), encoding="utf-8").read().splitlines()
body = [line for line in latex if line.endswith(r"\\")]
if len({len(re.findall(r"(?<!\\)&", line)) for line in body}) != 1 or len(body) != len(rows):
    found.append("results.tex: not one table with a row a cell")

print("\n".join(found))
sys.exit(1 if found else 0)
