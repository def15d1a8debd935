#!/usr/bin/env bash
# The test suite with pinned, newest and oldest versions, and without the extras:
#     tests/studies/versions.sh [PYTHON ...]        default: python3
# One line per combination at the end. oldest takes the lower bounds of pyproject.toml.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
oldest=$(sed -n 's/^dependencies = \[\(.*\)\]/\1/p; s/^\(cholmod\|plot\) = \[\(.*\)\]/\2/p' pyproject.toml |
  grep -oE '[a-z]+>=[0-9.]+' | sed 's/>=/==/')

run() { # NAME PYTHON PIP-ARGUMENTS...
  local name=$1 python=$2
  shift 2
  rm -rf "$folder/venv"
  "$python" -m venv "$folder/venv"
  if ! "$folder/venv/bin/python" -m pip install -q "$@" > "$folder/log" 2>&1; then
    echo "$name: cannot be installed: $(grep -m 1 ERROR "$folder/log")"
    return
  fi
  echo "$name, $("$folder/venv/bin/python" -V): $("$folder/venv/bin/python" -m pytest -p no:cacheprovider 2>&1 | tail -n 1)"
}

for python in "${@:-python3}"; do
  run pinned "$python" -c tests/constraints.txt -e '.[test]'
  run newest "$python" -e '.[test]'
  run oldest "$python" -e '.[cholmod,plot]' pytest hypothesis mpmath $oldest
  run "no extras" "$python" -c tests/constraints.txt -e . pytest hypothesis mpmath
done
