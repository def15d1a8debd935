"""NASA NTRT YAML: what was laid out and joined, built by its tags.

A cable pulls with k (l - l0), l0 = length - pretension / k once all stands in its place: law `paper`, EA = k.
A rod is rigid there; here it has the EA that the user gives.
"""

import os
from collections import Counter
from math import dist

from cgff_cli.errors import OptionError
from cgff_cli.formats.draft import Asked, Draft
from cgff_cli.formats.ntrt_file import Builder, NtrtFile
from cgff_cli.formats.ntrt_layout import Layout
from cgff_cli.formats.rest import rest_length_of
from cgff_cli.formats.yaml_values import Source
from cgff_cli.hints import count
from cgff_cli.scene.findings import first_few, quoted
from cgff_cli.scene.scene import KINDS


def read_ntrt(text: str, path: str, given: Asked) -> Draft:
    """Return what an NTRT file and its substructures say.

    Raises SceneError with every fault of any of the files, OptionError where rods lack --strut-EA.
    """
    source, draft = Source(text, path), Draft(path, "paper")
    if not source.document.whole:
        source.refuse()
    layout, top = Layout(draft), NtrtFile(source)
    layout.lay(top, "", (os.path.normpath(path),))
    unbuilt = _build(layout, draft, given) if source.findings.none else Counter()
    source.refuse()
    draft.files += layout.files
    lost = top.lost.union(*(file.lost for file in layout.files.values() if file))
    draft.assumed += [
        "units are the file's own; y is up in NTRT",
        "a string is a cable with force = k (l - l0): law paper, EA is its stiffness k, a force per length",
        "its l0 is its length less pretension / k; stiffness 1000, pretension 0 where none is given",
        f"a rod is rigid in NTRT; here EA {given.strut_EA}, as given, and l0 its length",
    ]
    draft.lost += [f"parameters of builders: {', '.join(sorted(lost))}"] * bool(lost)
    draft.lost += [
        f"{count(number, 'pair')} tagged {quoted(tags)}, for which there is no builder"
        for tags, number in unbuilt.items()
    ]
    _tell_of_welds(draft)
    return draft


def _build(layout: Layout, draft: Draft, given: Asked) -> Counter[str]:
    """Add nodes and elements to a draft; return how many pairs have no builder, by their tags."""
    for name, point in zip(layout.names, layout.points, strict=True):
        draft.node(name, point, draft.places.get(("nodes", name), (1, 1)))
    unbuilt: Counter[str] = Counter()
    last_first = layout.builders[::-1]
    order = [own for kind in KINDS[::-1] for own in last_first if own.kind == kind]  # rods come first
    chosen: dict[str, Builder | None] = {}
    for name, tags, a, b, file, where in layout.pairs:
        if tags not in chosen:
            words = frozenset(tags.split())
            chosen[tags] = next((own for own in order if own.tags <= words), None)
        builder = chosen[tags]
        if builder is None:
            unbuilt[name] += 1
            continue
        length: float | None = dist(layout.points[a], layout.points[b])
        EA = builder.stiffness
        if builder.kind == "strut":
            if given.strut_EA is None:
                raise OptionError(
                    "rods are rigid in NTRT: give their stiffness by --strut-EA, a force per length"
                )
            EA = given.strut_EA
        else:
            length = rest_length_of(
                file.source, where, dist(layout.points[a], layout.points[b]), builder.pretension, EA
            )
        if length is not None:
            draft.element(
                name, builder.kind, (layout.names[a], layout.names[b]), file.place(where), EA, length
            )
    return unbuilt


def _tell_of_welds(draft: Draft) -> None:
    rods = (pair for group in draft.groups.values() if group["kind"] == "strut" for pair in group["pairs"])
    ends = Counter(end for pair in rods for end in pair)
    shared = [name for name, number in ends.items() if number > 1]
    if shared:
        draft.lost.append(f"the welds of rods that share a node, pinned here: {first_few(shared)}")
