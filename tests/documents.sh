#!/usr/bin/env bash
# The documents: the manual formats, CITATION.cff is what CFF 1.2 asks for, links and named files exist, the glossary
# knows every metric, effect and target.  tests/documents.sh
set -u
cd "$(dirname "$0")/.." || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0 failed=0 skipped=0
check() { # check NAME COMMAND...: succeeds and prints nothing
  local name=$1
  shift
  if "$@" >"$work/log" 2>&1 && [ ! -s "$work/log" ]; then
    passed=$((passed + 1)); printf 'ok      %s\n' "$name"
  else
    failed=$((failed + 1)); printf 'FAILED  %s\n' "$name"; head -8 "$work/log" | sed 's/^/        /'
  fi
}
need() { # need PROGRAM NAME COMMAND...: a check that is skipped where the program is missing
  local program=$1
  shift
  if command -v "$program" >/dev/null; then check "$@"; else skipped=$((skipped + 1)); printf 'skipped %s (no %s)\n' "$1" "$program"; fi
}
mapfile -t documents < <(git ls-files --cached --others --exclude-standard '*.md')

./treeline help man >"$work/treeline.1"
need mandoc 'the manual page has no warning of mandoc' mandoc -T lint -W warning "$work/treeline.1"
need man 'the manual page has no warning of man' bash -c "man --warnings -l '$work/treeline.1' >/dev/null"
check 'the manual page names every verb and exit code' python3 - "$work/treeline.1" <<'P'
import re, subprocess, sys
page = open(sys.argv[1]).read()
verbs = re.findall(r"^  (\w+) ", subprocess.run(["./treeline", "help"], capture_output=True, text=True).stdout.split("\nmethods")[0], re.M)
codes = re.findall(r"^ +(\d+) +([\w-]+) ", subprocess.run(["./treeline", "help", "exit"], capture_output=True, text=True).stdout, re.M)
assert len(verbs) >= 8 and len(codes) >= 15, (verbs, codes)
for verb in verbs:
    assert f".SS {verb}\n" in page, verb
for code, word in codes:
    assert f"\n{code} {word}\n" in page, word
P
check 'CITATION.cff holds to CFF 1.2.0 and cites five papers' python3 - CITATION.cff <<'P'
import sys, yaml  # keys and types of the schema, https://doi.org/10.5281/zenodo.5171937
cff = yaml.safe_load(open(sys.argv[1]))
TOP = set("abstract authors cff-version commit contact date-released doi identifiers keywords license license-url message"
          " preferred-citation references repository repository-artifact repository-code title type url version".split())
PERSON = set("address affiliation alias city country email family-names fax given-names name-particle name-suffix orcid"
             " post-code region tel website".split())
ENTITY = set("address alias city country date-end date-start email fax location name orcid post-code region tel website".split())
TYPES = set("art article audiovisual bill blog book catalogue conference conference-paper data database dictionary edited-work"
            " encyclopedia film-broadcast generic government-document grant hearing historical-work legal-case legal-rule"
            " magazine-article manual map multimedia music newspaper-article pamphlet patent personal-communication proceedings"
            " report serial slides software software-code software-container software-executable software-virtual-machine"
            " sound-recording standard statute thesis unpublished video website".split())
REFERENCE = set("abbreviation abstract authors collection-title conference copyright date-published doi editors end institution"
                " isbn issn issue journal keywords languages license month notes number pages publisher start status"
                " thesis-type title type url volume year".split())
def people(authors):
    assert authors
    for a in authors:
        assert set(a) <= ENTITY if "name" in a else set(a) <= PERSON and "family-names" in a, a
assert {"cff-version", "message", "title", "authors"} <= set(cff) <= TOP, set(cff) - TOP
assert cff["cff-version"] == "1.2.0" and cff["type"] in ("software", "dataset") and cff["license"] == "MIT"
people(cff["authors"])
assert len(set(cff["keywords"])) == len(cff["keywords"])
assert len(cff["references"]) == 5
for r in cff["references"]:
    assert {"authors", "title", "type"} <= set(r) <= REFERENCE, set(r) - REFERENCE
    assert r["type"] in TYPES and isinstance(r["title"], str)
    assert isinstance(r.get("year", 1), int) and r.get("month", 1) in range(1, 13)
    assert set(r.get("institution", {})) <= ENTITY and all(len(l) in (2, 3) for l in r.get("languages", []))
    people(r["authors"])
P
check 'links and named files of every document exist' python3 - "${documents[@]}" <<'P'
import os, re, sys
bad = []
def anchors(path):
    return {re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower()).replace(" ", "-")
            for line in open(path) if line.startswith("#")}
for document in sys.argv[1:]:
    text, folder = open(document).read(), os.path.dirname(document)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"(https?|mailto):", target):
            continue
        path, _, anchor = target.partition("#")
        path = os.path.join(folder, path) if path else document
        if not os.path.exists(path):
            bad.append(f"{document}: {target}")
        elif anchor and path.endswith(".md") and anchor not in anchors(path):
            bad.append(f"{document}: {target}: no such heading")
    for named in re.findall(r"`((?:harness|tests|scenes|results|reports|methods|\.ci)/[\w./-]*\.(?:md|h|c|sh|json|glsl|py))`", text):
        if not re.search(r"NAME|my[-_]", named) and not os.path.exists(named):
            bad.append(f"{document}: {named}")
print(*bad, sep="\n", end="")
sys.exit(bool(bad))
P
check 'commands of every document name verbs, options, methods and scenes that there are' python3 - "${documents[@]}" <<'P'
import json, re, subprocess, sys
def treeline(*words):
    return subprocess.run(["./treeline", *words], capture_output=True, text=True)
def names(what):
    return {row["name"] for row in json.loads(treeline("list", what, "--json").stdout)[what]}
known = {"--method": names("methods"), "--scene": names("scenes")}
helps, bad, commands = {}, [], 0
for document in sys.argv[1:]:
    text = open(document).read()
    lines = re.findall(r"^ {4}(?:.* && )?(?:\./)?treeline (.*)$", text, re.M)
    lines += [span.partition("treeline ")[2] for span in re.findall(r"`((?:\./)?treeline [^`]*)`", text)]
    for line in lines:
        words = re.sub(r" #.*", "", line.replace("\n", " ")).split()
        if not re.fullmatch("[a-z]+", words[0]):
            continue  # VERB
        commands += 1
        if words[0] not in helps:
            shown = treeline("help", words[0])
            helps[words[0]] = shown.stdout if shown.returncode == 0 else ""
        missing = [w for w in words[1:] if re.match("--[a-z]", w) and not re.search(w + r"\b", helps[words[0]])]
        missing += [v for o, v in zip(words, words[1:]) if o in known and "." not in v and not v.startswith("my-")
                    and v.partition(":")[0] not in known[o]]
        if not helps[words[0]] or missing:
            bad.append(f"{document}: treeline {' '.join(words)}: {' '.join(missing) or words[0]}")
assert commands > 30, commands
print(*bad, sep="\n", end="")
sys.exit(bool(bad))
P
check 'the glossary is sorted and knows every metric, effect, target and level' python3 - GLOSSARY.md <<'P'
import json, re, subprocess, sys
rows = [line.split("|")[1].strip() for line in open(sys.argv[1]) if line.startswith("| ")][1:]
assert rows == sorted(rows, key=str.lower), [r for r, s in zip(rows, sorted(rows, key=str.lower)) if r != s][:2]
assert len(set(rows)) == len(rows)
text = open(sys.argv[1]).read().lower()
metrics = [m["word"] if "word" in m else m["name"] for m in
           json.loads(subprocess.run(["./treeline", "list", "metrics", "--json"], capture_output=True, text=True).stdout)["metrics"]]
effects = re.findall(r'X\(EFFECT_\w+, [^,]+, "([a-z-]+)"', open("harness/scene/effects.h").read())
assert len(metrics) >= 13 and len(effects) >= 5, (metrics, effects)
for word in metrics + effects + ["rgba8", "rgba16f", "rgba32f", "intermediate", "osmesa", "egl-surfaceless"]:
    assert re.sub(r"^rmse(?=-)", "", word) in text, word
P
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
