"""Time and memory of reading and writing large scenes, with and without one mistake, beside another checkout.

    python tests/studies/reading.py [--before PATH] [--elements 100000 1000000] [--yaml-up-to N] [--repeat 3]

Scenes are cable nets of about so many elements, half as many nodes, and chains with as many nodes as links,
as YAML, as JSON and as CSV tables. The mistakes: a word for a number in the middle node, an unknown node at
the end of the last element, a node that stands twice. Every measurement is a process of its own; time is that
of the processor from import on, memory the peak of the whole process, each the least of all repeats. `x` is
now over before, `of clean` now over reading the same scene without a mistake. Linux only.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
MEASURE = """
import re, sys, time
import numpy
import cgff_cli, cgff_cli.scene.read, cgff_cli.scene.write, cgff_cli.scene.tables_out
from pathlib import Path
action, name, *given = sys.argv[1:]
made = cgff_cli.new(name, **{given[0]: int(given[1])}) if action.startswith("write") else None
start = time.process_time()
try:
    if action == "read":
        cgff_cli.load(name)
    elif action == "write-yaml":
        Path(given[2]).write_text(cgff_cli.to_yaml(made))
    else:
        with open(given[2] + ".nodes.csv", "w") as file:
            file.writelines(cgff_cli.scene.tables_out.node_table(made))
        with open(given[2] + ".elements.csv", "w") as file:
            file.writelines(cgff_cli.scene.tables_out.element_table(made))
    said = "ok"
except cgff_cli.SceneError as error:
    said = str(error)
peak = int(re.search(r"VmHWM:\\s*(\\d+)", Path("/proc/self/status").read_text()).group(1)) / 1024
print(time.process_time() - start, peak, said.replace("\\n", " | ")[:200])
"""


def measured(root, repeat, *arguments):
    """Return the least processor seconds and megabytes of a measurement, and what was said."""
    environment = {**os.environ, "PYTHONPATH": str(root), "OPENBLAS_NUM_THREADS": "1"}
    runs = []
    for _ in range(repeat):
        command = [sys.executable, "-c", MEASURE, *map(str, arguments)]
        run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, cwd=root)
        seconds, megabytes, said = run.stdout.rstrip("\n").split(" ", 2)
        runs.append((float(seconds), float(megabytes), said))
    return min(run[0] for run in runs), min(run[1] for run in runs), runs[0][2]


def as_json(scene):
    """Return a scene as JSON on one line."""
    names = scene.node_names
    groups = {
        group.name: {
            "kind": group.kind,
            "EA": group.EA.tolist(),
            "rest_length": group.rest_length.tolist(),
            "pairs": [[names[a], names[b]] for a, b in group.pairs.tolist()],
        }
        for group in scene.groups
    }
    nodes = dict(zip(names, scene.coordinates.tolist(), strict=True))
    supports = {names[row]: axes for row, axes in scene.supports.items()}
    loads = {names[row]: load for row, load in scene.loads.items()}
    values = {"law": scene.law, "nodes": nodes, "elements": groups, "supports": supports, "loads": loads}
    return json.dumps(values)


def last_replaced(text, old, new):
    """Return a text with the last place of some words changed."""
    begin, _, end = text.rpartition(old)
    return begin + new + end


def written(folder, name, size, with_yaml):
    """Write a scene in every form, whole and with mistakes; return form -> {mistake: path}."""
    import cgff_cli
    from cgff_cli.scene.tables_out import element_table, node_table

    scene = cgff_cli.new(name, jitter=0.01, **size)
    names, last = scene.node_names, scene.groups[-1].pairs[-1, 0]
    middle, end = names[len(names) // 2], names[last]
    nodes, elements = "".join(node_table(scene)), "".join(element_table(scene))
    text = as_json(scene)
    node = re.search(rf'"{middle}": \[[^]]+\], ', text).group()
    row = re.search(rf"\n{middle},.*", nodes).group()
    forms = {
        "json": {
            "": text,
            "number": text.replace(node, re.sub(r"\[[^,]+", '["half"', node), 1),
            "unknown": last_replaced(text.partition('"supports"')[0], f'["{end}"', '["nowhere"')
            + text[text.index('"supports"') :],
            "twice": text.replace(node, node * 2, 1),
        },
        "tables": {
            "": (nodes, elements),
            "number": (nodes.replace(row, re.sub(r",[^,]+", ",half", row, count=1), 1), elements),
            "unknown": (nodes, last_replaced(elements, f"\n{end},", "\nnowhere,")),
            "twice": (nodes.replace(row, row * 2, 1), elements),
        },
    }
    if with_yaml:
        text = cgff_cli.to_yaml(scene)
        line = re.search(rf"\n  {middle}: .*", text).group()
        forms["yaml"] = {
            "": text,
            "number": text.replace(line, re.sub(r"\[[^,]+", "[half", line), 1),
            "unknown": last_replaced(text.partition("\nsupports:")[0], f"[{end},", "[nowhere,")
            + text[text.index("\nsupports:") :],
            "twice": text.replace(line, line * 2, 1),
        }
    head = cgff_cli.to_yaml(scene, "", ("NODES", "ELEMENTS"))
    return {
        form: {
            mistake: _put(folder, f"{name}-{form}-{mistake}", form, content, head)
            for mistake, content in own.items()
        }
        for form, own in forms.items()
    }


def _put(folder, stem, form, content, head):
    path = folder / f"{stem}.{'json' if form == 'json' else 'yaml'}"
    if form == "tables":
        for kind, table in zip(("nodes", "elements"), content, strict=True):
            (folder / f"{stem}.{kind}.csv").write_text(table)
            head = head.replace(kind.upper(), f"{stem}.{kind}.csv", 1)
        content = head
    path.write_text(content)
    return path


def told(what, now, clean, before):
    """Print one row of the table."""
    of_clean = f"{now[0] / clean[0]:5.2f}{now[1] / clean[1]:6.2f}" if clean else " " * 11
    beside = ""
    if before:
        same = "" if before[2] == now[2] else f"  SAID BEFORE: {before[2][:90]}"
        beside = f"{before[0]:9.2f}{before[1]:7.0f}{now[0] / before[0]:7.2f}{now[1] / before[1]:6.2f}{same}"
    print(f"{what:34}{now[0]:7.2f}{now[1]:7.0f} {of_clean}{beside}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--before", type=Path, help="root of another checkout")
    parser.add_argument("--elements", type=int, nargs="+", default=[100_000, 1_000_000])
    parser.add_argument("--yaml-up-to", type=int, default=100_000, help="most elements of a YAML scene")
    parser.add_argument("--repeat", type=int, default=3)
    given = parser.parse_args()
    sys.path.insert(0, str(ROOT))
    roots = [ROOT, *([given.before.resolve()] if given.before else [])]
    print(f"{'':34}{'s':>7}{'MB':>7}  of clean   " + ("   s before  MB      x     x" if given.before else ""))
    for count in given.elements:
        for name, size in (("net", {"side": round((count / 2) ** 0.5) + 2}), ("catenary", {"links": count})):
            with tempfile.TemporaryDirectory() as folder:
                forms = written(Path(folder), name, size, count <= given.yaml_up_to)
                for form, paths in forms.items():
                    clean = None
                    for mistake, path in paths.items():
                        now, *before = [measured(root, given.repeat, "read", path) for root in roots]
                        told(f"read {name} {count} {form} {mistake}", now, clean, before and before[0])
                        clean = clean or now
                for action in ("write-yaml", "write-tables"):
                    out = (action, name, *next(iter(size.items())), Path(folder) / "out.yaml")
                    now, *before = [measured(root, given.repeat, *out) for root in roots]
                    told(f"{action} {name} {count}", now, None, before and before[0])


if __name__ == "__main__":
    main()
