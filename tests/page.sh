#!/usr/bin/env bash
# The report's page in a real browser, driven by clicks.  tests/page.sh [FOLDER for pictures, to look at]; needs
# chromium and python3-websocket, skips without.
set -u
look=${1:+$(realpath "$1")}
cd "$(dirname "$0")/.." || exit 1
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
if [ -z "$browser" ] || ! /usr/bin/python3 -c 'import websocket' 2>/dev/null; then
  echo "0 passed, 0 failed, 1 skipped"
  exit 0
fi
make -s build/release-gcc/tests/test_report build/release-gcc/tests/test_papers all || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OMP_WAIT_POLICY=passive TREELINE_DATA="${TREELINE_DATA:-$PWD}"
build/release-gcc/tests/test_report page "$work/run" "$work/out" || exit 1
build/release-gcc/tests/test_report many "$work/many" "$work/many-out" || exit 1
build/release-gcc/tests/test_papers page "$work/papers" "$work/papers-out" || exit 1
PYTHONDONTWRITEBYTECODE=1 timeout 170 /usr/bin/python3 tests/page_live.py "$browser" "$work/out" "$work/many-out" "$work/papers-out" ${look:+"$look"}
