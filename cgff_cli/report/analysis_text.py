"""An analysis as a page for the terminal: what it comes to in plain words, then the figures."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from rich.console import RenderableType
from rich.text import Text

from cgff_cli.analysis.sensitivity import Sensitivity
from cgff_cli.analysis.slackening import slack_words
from cgff_cli.as_given import Analysis
from cgff_cli.hints import count
from cgff_cli.report.table import analysis_words, changes_table, group_table, structure_words
from cgff_cli.report.terminal import Aligned, Column, clean, fields, heading, number, numbers

_CLEAR = 1e9
"""Gap of singular values whose digits nobody needs: what is left out is rounding."""

_TITLES = {
    "stable": ("stable", "bold green"),
    "unstable": ("unstable", "bold red"),
    "neutral": ("neutral", "bold yellow"),
    None: ("stability not told", "bold yellow"),
}


def analysis_page(found: Analysis, full: bool = False) -> Iterator[RenderableType]:
    """Yield the page; full: of sensitivities, how every node moves."""
    analysis = found.analysis
    kind = _TITLES[analysis["stability"]] if found.balanced else ("out of balance", "bold red")
    if found.is_geometry:
        kind = ("geometry", "bold")
    yield Text.assemble(heading(found.result.source), "  ", kind)
    yield fields(_facts(found))
    if analysis["modes"]:
        yield _modes(analysis["modes"])
    forces = () if found.is_geometry else ("force", "force_density")
    yield group_table(found.result, ("length", *forces))
    for of, own in found.sensitivity.items():
        yield from _sensitivity(found, of, own, full)


def _facts(found: Analysis) -> Iterator[tuple[str, str]]:
    analysis = found.analysis
    yield "verdict", "; ".join(filter(None, (clean(found.message), _stability(analysis), _load(analysis))))
    yield "structure", structure_words(found.result.source)
    if found.residual is not None:
        yield "residual", f"{found.residual['max']:.2e}, rounding {found.residual['rounding_floor']:.1e}"
    yield "analysis", analysis_words(analysis)
    gap = analysis["rank_gap"]
    if gap is not None:
        apart = f"a factor of {gap:.1e}" if gap < _CLEAR else f"more than a factor of {_CLEAR:.0e}"
        yield "rank", f"singular values that count and those that do not are {apart} apart"
    if analysis["tangent_eigenvalues"]:
        yield "stiffness", f"least: {', '.join(map(number, analysis['tangent_eigenvalues']))}"
    names: dict[str, list[str]] = {}
    for name, why in analysis["reason"].items():
        names.setdefault(why.removeprefix("not told: "), []).append(name)
    yield from (("warning", clean(warning)) for warning in found.warnings)
    yield from (("not told", f"{', '.join(own)}: {clean(why)}") for why, own in names.items())


def _stability(analysis: dict[str, Any]) -> str:
    """Return what stability comes to, in plain words; nothing where it is not told."""
    if analysis["stability"] == "stable":
        by = (
            " by its stress alone, whatever the stiffness of its elements" if analysis["super_stable"] else ""
        )
        return f"it is stable{by}: every deformation costs energy"
    if analysis["stability"] == "unstable":
        falls = analysis["negative_eigenvalues"]
        ways = "some way" if falls is None else count(falls, "independent way")
        return f"it is unstable: there is energy to be gained in {ways} to deform it"
    if analysis["stability"] == "neutral":
        return "it is neutral: some deformation meets no resistance beyond rounding"
    return ""


def _load(analysis: dict[str, Any]) -> str:
    """Return at which multiples of the loads stiffness is lost, and before that a cable goes slack."""
    factor, slack = analysis["critical_load_factor"], analysis["first_slack_factor"]
    lost = "" if factor is None else f"its stiffness is lost at {number(factor)} times the loads"
    if slack is None or (factor is not None and 1.0 < factor < slack):
        return lost
    goes = clean(slack_words(analysis["first_slack_cables"], slack))
    if factor is not None and slack <= factor:
        return f"{lost} as if no cable went slack, but {goes}"
    return "; ".join(filter(None, (lost, goes)))


def _modes(modes: list[dict[str, Any]]) -> Aligned:
    known = [mode["stiffness"] is not None for mode in modes]
    values = numbers([mode["stiffness"] if own else 0.0 for mode, own in zip(modes, known, strict=True)])
    return Aligned(
        [
            Column("motion", [mode["kind"] for mode in modes]),
            Column(
                "stiffness", [text if own else "-" for text, own in zip(values, known, strict=True)], True
            ),
            Column("moves most", [", ".join(map(clean, mode["main_nodes"])) for mode in modes]),
        ]
    )


def _sensitivity(found: Analysis, of: str, own: Sensitivity, full: bool) -> Iterator[RenderableType]:
    """Yield what a unit of rest length does: the nodes that move most, and forces by group."""
    X, t, reason = own
    if X is None or t is None:
        yield fields([(f"per unit of {clean(of)}", reason)])
        return
    names, size = found.result.source.node_names, np.linalg.norm(X, axis=1)
    shares = (size / (size.max() or 1.0)).round(6)  # what is equal but for rounding stays in order
    order = np.argsort(-shares, kind="stable")
    most = [row for row in order[: len(names) if full else 3].tolist() if size[row] > 0.0]
    moved = ", ".join(f"{clean(names[row])} {number(size[row])}" for row in most)
    moves = f"nodes move, most of all {moved}" if most else "no node moves"
    yield fields([(f"per unit of {clean(of)}", f"{moves}; forces change")])
    yield changes_table(found.result, t)
