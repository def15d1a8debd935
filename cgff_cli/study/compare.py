"""The same scene by CGFF and by others: one reference, then every method in turn, several times over."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.options import SolveOptions
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.task import Reference
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers import cgff
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import Structure, from_scene
from cgff_cli.study.alignment import alignment_of
from cgff_cli.study.judge import Answer, judged, nodes, solution_at
from cgff_cli.study.record import Comparison, Method
from cgff_cli.study.runs import Case, Run, run

TOLERANCE = 1e-12
"""Where all methods stop unless told otherwise: the last point of the curves."""

FLOOR = 1e-15
"""Tolerance of the reference: below what doubles can tell, so that it ends at the rounding floor."""

REPEAT = 3
TIME_LIMIT = 60.0

Observer = Callable[[str, int], None]
"""Called before every run with the method's name and the number of the run, from 1."""


def compare(
    scene: Scene | str,
    methods: Iterable[str] = ("fdm",),
    *,
    repeat: int = REPEAT,
    time_limit: float = TIME_LIMIT,
    observer: Observer | None = None,
    **changes: object,
) -> Comparison:
    """Form-find a scene, or the scene file at a path, by CGFF and by other methods.

    methods    : names out of REGISTRY, or "all"; cgff itself is always the first. On a scene with supports
                 fdm stands for schek
    repeat     : runs of each method, taken in turn, of which times are the median; one that failed or ran
                 out of time is not run again
    time_limit : seconds after which a run is ended
    Other keywords are solve options, which win over the scene's own; tolerance is 1e-12 unless given.
    Raises SceneError for a bad file, OptionError for a bad name or option; a method that fails is a row.
    """
    if not isinstance(scene, Scene):
        from cgff_cli.scene.read import load

        scene = load(scene)
    if repeat < 1 or not time_limit > 0.0:
        raise OptionError(f"repeat and time_limit must be positive, got {repeat} and {time_limit:g}")
    options = SolveOptions(tolerance=TOLERANCE).merged({**scene.solver, **changes, "method": "cgff"})
    structure = from_scene(scene)
    names = chosen(methods, bool(scene.supports))
    best = _reference(structure, options)
    case = Case(
        structure=structure,
        groups=np.repeat(np.arange(len(scene.groups)), [len(group.EA) for group in scene.groups]),
        options=options,
        time_limit=time_limit,
        reference=Reference(best.shape, best.force_densities),
        alignment=alignment_of(best.shape, structure.free),
    )
    runs: dict[str, list[Run]] = {name: [] for name in names}
    for number in range(1, repeat + 1):
        for name in names:
            if any(own.tells_all for own in runs[name]):
                continue
            if observer is not None:
                observer(name, number)
            runs[name].append(run(name, case))
    asked = {"repeat": repeat, "time_limit": time_limit}
    return Comparison(scene, asked | options.to_dict(), _told(scene, best), _rows(scene, case, runs))


def chosen(methods: Iterable[str], has_supports: bool) -> list[str]:
    """Return the methods to run, cgff first, each once; raises OptionError for an unknown name."""
    wanted = ["cgff"]
    for name in methods:
        if name not in (*REGISTRY, "all"):
            raise OptionError(f"unknown method {name!r}; allowed: {', '.join(REGISTRY)}, all")
        wanted += [other for other in REGISTRY if other != "schek"] if name == "all" else [name]
    told = ["schek" if name == "fdm" and has_supports else name for name in wanted]
    return list(dict.fromkeys(told))


def _reference(structure: Structure, options: SolveOptions) -> Solution:
    """Return the answer to the rounding floor; raises KeyboardInterrupt on Ctrl-C."""
    best = cgff.form_find(structure, replace(options, tolerance=FLOOR, objective="energy"))
    if best.verdict is Verdict.INTERRUPTED:
        raise KeyboardInterrupt
    return best


def _told(scene: Scene, best: Solution) -> dict[str, object]:
    return {
        "verdict": best.verdict.value,
        "residual_relative": best.relative,
        "energy": best.energy,
        "nodes": nodes(scene, best.coordinates),
    }


def _rows(scene: Scene, case: Case, runs: dict[str, list[Run]]) -> tuple[Method, ...]:
    """Return one row per method, CGFF's first, which the others are held against."""
    own = runs["cgff"][0].end
    answer = None
    if own is not None:
        found = solution_at(case, own.X)
        answer = Answer(found.shape, found.lengths, found.force_densities)
    return tuple(
        judged(scene, case, name, own_runs, None if name == "cgff" else answer)
        for name, own_runs in runs.items()
    )
