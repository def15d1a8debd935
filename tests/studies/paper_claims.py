"""What the paper claims, measured: its tables, iteration counts, speed and convexity.

    python tests/studies/paper_claims.py [tables] [iterations] [speed] [convexity] [relatives] [--json FILE]
        [--readme]

All parts unless some are named; about seven minutes. --json writes what was measured, keeping the parts of
an existing file that were not measured again; --readme measures nothing and rewrites the table of README.md
from paper_claims.json, both beside this file.
"""

import argparse
import json
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.studies.claims import convexity, iterations, readme, relatives, speed, tables

ROOT = Path(__file__).parents[2]
PARTS = {
    "tables": (tables, {}),
    "iterations": (iterations, {"count": 20}),
    "speed": (speed, {"count": 20, "repeat": 7}),
    "convexity": (convexity, {"count": 100, "segments": 10_000}),
    "relatives": (relatives, {"count": 20}),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", help=f"out of {', '.join(PARTS)}; all unless given")
    parser.add_argument("--json", metavar="FILE", type=Path)
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    if unknown := set(arguments.parts) - set(PARTS):
        parser.error(f"unknown parts: {', '.join(sorted(unknown))}")
    if arguments.readme:
        readme.rewrite(readme.PAGE, readme.committed())
        return
    found = {}
    for name in arguments.parts or PARTS:
        part, sizes = PARTS[name]
        found[name] = part.measure(**sizes)
        print(f"{name}: {part.__doc__.splitlines()[0]}\n")
        part.show(found[name])
        print(flush=True)
    if arguments.json:
        kept = json.loads(arguments.json.read_text()) if arguments.json.exists() else {}
        arguments.json.write_text(json.dumps(kept | found, indent=1) + "\n")
    if set(found) == set(PARTS):
        print(readme.text(found))


if __name__ == "__main__":
    main()
