#!/usr/bin/env bash
# The test suite with pinned, newest and oldest versions, and without each extra:
#     tests/studies/versions.sh [PYTHON ...]        default: python3
# One line per combination, and what of the first is not pinned; oldest takes the lower bounds of
# pyproject.toml.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
oldest=$(grep -oE '[a-z]+>=[0-9.]+' pyproject.toml | sed 's/>=/==/')

run() { # NAME PYTHON PIP-ARGUMENTS...
  local name="$1, $("$2" -V)" bin=$folder/venv/bin
  rm -rf "$folder/venv"
  "$2" -m venv "$folder/venv"
  if "$bin/python" -m pip install -q "${@:3}" > "$folder/log" 2>&1; then
    echo "$name: $("$bin/python" -m pytest -p no:cacheprovider 2>&1 | tail -n 1)"
  else
    echo "$name: cannot be installed: $(grep -m 1 ERROR "$folder/log")"
  fi
}

for python in "${@:-python3}"; do
  run pinned "$python" -c tests/constraints.txt -e '.[test]'
  "$folder/venv/bin/python" -m pip freeze --exclude-editable | grep -vxF -f tests/constraints.txt
  run newest "$python" -e '.[test]'
  run oldest "$python" -e '.[test]' $oldest
  run "without cvxopt" "$python" -c tests/constraints.txt -e '.[plot]' pytest hypothesis mpmath
  run "without matplotlib" "$python" -c tests/constraints.txt -e '.[cholmod]' pytest hypothesis mpmath
done
