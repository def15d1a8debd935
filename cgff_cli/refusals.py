"""Why a shape cannot be prestressed, and what to look at twice where it can, in words that help."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cgff_cli.analysis.equilibrium import STABILITY_WORDS, labels
from cgff_cli.analysis.prestress import STRAIN, Answer
from cgff_cli.analysis.ranks import LEAST_TOLERANCE
from cgff_cli.result import Result
from cgff_cli.scene.findings import first_few, quoted
from cgff_cli.scene.scene import Scene

UNSURE = ("undecided", "inexact", "blurred", "weight")
"""Why an answer may lack a self-stress without proof that there is none."""

EXTREME = "scale or shape may be too extreme for double precision"
STILL = 1e-9
"""Share of the greatest motion of a node below which a node is not said to move."""

NEARLY_BORNE = 1e-13, 1e-6
"""What is left over of loads that coordinates bear but for rounding of their own."""

ROUNDED = 1e-2
"""Least singular value below which coordinates may have been rounded, or measured."""


def refusal(scene: Scene, answer: Answer, asked: Mapping[str, Any]) -> str:
    """Return the sentence for what an answer lacks; asked: the options of `prestress`."""
    said = {
        "no_state": _no_state(answer, asked),
        "no_group_state": _no_group_state(answer, asked),
        "signs": _signs(scene, answer, asked),
        "loads": _loads(scene, answer, asked),
        "rest_length": _rest_length(scene, answer),
        "force": _force(answer, asked),
        "inexact": _inexact(answer, asked),
        "weight": "rest lengths decide the weight, and none were found whose own this shape bears: it is not "
        "proven that there are none; a shape that `cgff solve` finds with it, no cable slack and no strut in "
        "tension, has some",
        "blurred": "rounding decides: some rest lengths are so near the lengths that double precision does "
        "not hold these forces; raise the force, or lower EA",
        "undecided": _undecided(answer, asked),
    }
    return said[answer.why]


def _undecided(answer: Answer, asked: Mapping[str, Any]) -> str:
    is_tolerant = asked["tolerance"] > LEAST_TOLERANCE
    if not is_tolerant and NEARLY_BORNE[0] < answer.left_over <= NEARLY_BORNE[1]:
        return _inexact(answer, asked)
    decides, advice = ("the tolerance", "try a smaller one") if is_tolerant else ("rounding", EXTREME)
    return (
        f"{decides} decides: neither a self-stress of the right signs was found nor a proof that there is "
        f"none; {advice}"
    )


def _count(number: int | None, noun: str) -> str:
    return f"{number or 'no'} {noun}{'' if number == 1 else 's'}"


def _no_state(answer: Answer, asked: Mapping[str, Any]) -> str:
    more = (answer.mechanisms or 0) + 1
    return (
        f"no self-stress: {_count(answer.mechanisms, 'mechanism')} and no state; a structure in general "
        f"position needs {_count(more, 'more member')} for one{_rounded(answer)}"
    )


def _rounded(answer: Answer) -> str:
    """Return what may help where coordinates were rounded."""
    if answer.softest is None or not LEAST_TOLERANCE < answer.softest <= ROUNDED:
        return ""
    enough = float(f"{2.0 * answer.softest:.1e}")
    return (
        f"; the least singular value is {answer.softest:.2g}: if the coordinates were rounded or measured, "
        f"a tolerance of {enough:g} takes it for a state and moves them to where it is one"
    )


def _shared(asked: Mapping[str, Any]) -> str:
    return f"one {asked['equal']} per {'group' if asked['by_group'] else 'class of symmetry'}"


def _no_group_state(answer: Answer, asked: Mapping[str, Any]) -> str:
    states = _count(answer.states, "state")
    return f"no self-stress has {_shared(asked)}; without that there is {states}{_rounded(answer)}"


def _signs(scene: Scene, answer: Answer, asked: Mapping[str, Any]) -> str:
    never, idle = np.flatnonzero(answer.never), np.flatnonzero(answer.idle)
    wrong = np.setdiff1d(never, idle)
    own = f" ({first_few(labels(scene, wrong))})" if len(wrong) else ""
    told = [f"{len(wrong)} can carry force, but never of their sign{own}"] if len(wrong) else []
    told += [f"{len(idle)} carry none in any state ({first_few(labels(scene, idle))})"] if len(idle) else []
    shared = f" with {_shared(asked)}" if asked["by_group"] or asked["by_symmetry"] else ""
    is_loaded = bool(answer.structure.loads[answer.structure.free].any())
    does = "bears the loads with the right signs" if is_loaded else "has the right signs"
    what = f"no self-stress{shared} {does} in all {len(answer.never)} elements"
    return f"{what}: {'; '.join(told)}; by group: {in_groups(scene, never)}"


def in_groups(scene: Scene, rows: np.ndarray) -> str:
    """Return how many of the elements of each group are among some, in words."""
    owners = scene.owners
    counts = np.bincount(owners[rows], minlength=len(scene.groups))
    parts = [
        f"{counts[i]} of {len(group.EA)} in {quoted(group.name)}"
        for i, group in enumerate(scene.groups)
        if counts[i]
    ]
    return ", ".join(parts)


def _loads(scene: Scene, answer: Answer, asked: Mapping[str, Any]) -> str:
    moved = np.zeros(0) if answer.motion is None else np.linalg.norm(answer.motion, axis=1)
    order = np.argsort(-moved.round(9), kind="stable")[:3]
    most = [scene.node_names[row] for row in order[moved[order] > STILL * moved.max(initial=0.0)].tolist()]
    if asked["by_group"] or asked["by_symmetry"]:
        what = f"no forces of the right signs with {_shared(asked)} bear the loads"
        how = "all cables that share a value are together not lengthened, nor such struts shortened"
    else:
        what, how = (
            "no forces of the right signs bear the loads",
            "no cable is lengthened nor strut shortened",
        )
    return (
        f"{what}: there is a motion along which they do work, and {how}; it moves {first_few(most)} the most"
    )


def _rest_length(scene: Scene, answer: Answer) -> str:
    if answer.rest_lengths is None:
        return ""
    rows = np.flatnonzero(np.isnan(answer.rest_lengths))
    EA = scene.axial_stiffness
    named = quoted(labels(scene, rows[:1])[0]) if len(rows) else ""
    first = int(rows[0]) if len(rows) else 0
    return (
        f"no rest length above 0 gives {named} the force {answer.forces[first]:.6g} with EA {EA[first]:g} "
        f"({_count(len(rows), 'such element')}); lower the force, or raise EA"
    )


def _force(answer: Answer, asked: Mapping[str, Any]) -> str:
    (name, value), *_ = asked["force"].items() or [("", 0.0)]
    reached = answer.force_reached or 0.0
    edge = "at least" if reached > abs(value) else "at most"
    edge = f"{edge} " if answer.states else ""
    return (
        f"with these loads the greatest force in {quoted(name)} is {edge}{reached:.6g}, "
        f"and no self-stress makes it {abs(value):g}"
    )


def _inexact(answer: Answer, asked: Mapping[str, Any]) -> str:
    enough = f"{max(1e-8, 10.0 * answer.left_over):.0e}".replace("e-0", "e-")
    if asked["tolerance"] > LEAST_TOLERANCE:
        return (
            "no shape near these coordinates was found that balances a self-stress of the right signs "
            f"({answer.left_over:.1e} of its forces left over); a smaller tolerance may name other states"
        )
    return (
        f"these coordinates balance a self-stress only to {answer.left_over:.1e} of its forces: they were "
        "rounded, or solved for no further; `cgff solve --tolerance 1e-14` finds them to rounding, or a "
        f"tolerance of {enough} moves them to where it balances"
    )


def second_looks(answer: Answer, result: Result) -> tuple[str, ...]:
    """Return what deserves a second look in the level and in the stability found, and why that is null."""
    stability, reasons = result.analysis["stability"], result.analysis["reason"]
    said = [] if result.converged else [f"the forces balance only to {result.residual['relative']:.1e}"]
    said += [f"{name}: {reasons[name]}" for name in ("stability", "super_stable") if name in reasons]
    if answer.is_given:
        said.append(
            "the rest lengths are the scene's own, which hold this shape: whether others do, and are better "
            "balanced, rounding hides"
        )
    if answer.strain_needed is not None:
        members = "cables" if answer.structure.tension_only.any() else "struts"
        said.append(
            f"the loads alone strain {members} by {answer.strain_needed:.3g}, more than the {STRAIN:g} that "
            "prestress aims at; raise EA, or give a force"
        )
    if stability == "unstable":
        said.append(
            "unstable: this self-stress balances but holds nothing: the least disturbance makes the "
            "structure leave this shape; try other states, members or supports"
        )
    elif stability in STABILITY_WORDS:
        said.append(STABILITY_WORDS[stability])
    return tuple(said)
