"""The same scene by CGFF and by others: one reference, then every method in turn, several times over."""

from collections.abc import Callable, Iterable
from dataclasses import replace

from cgff_cli.errors import OptionError
from cgff_cli.options import SolveOptions
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.task import Task
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers import cgff
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import from_scene
from cgff_cli.study.alignment import alignment_of
from cgff_cli.study.judge import Attempt, attempted, judged, solution_at
from cgff_cli.study.record import Comparison

TOLERANCE = 1e-12
"""Where all methods stop unless told otherwise: the last point of the curves."""

FLOOR = 1e-15
"""Tolerance of the reference: below what doubles can tell, so that it ends at the rounding floor."""

BeforeRun = Callable[[str, int], None]
"""Called before every run with the method's name and the number of the run, from 1."""


def compare(
    scene: Scene | str,
    methods: Iterable[str] = ("fdm",),
    *,
    repeat: int = 3,
    time_limit: float = 60.0,
    observer: BeforeRun | None = None,
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
    names = chosen(methods, bool(scene.supports))
    task = _task(scene, options)
    runs: dict[str, list[Attempt]] = {name: [] for name in names}
    for number in range(1, repeat + 1):
        for name in names:
            if any(own.tells_all for own in runs[name]):
                continue
            if observer is not None:
                observer(name, number)
            runs[name].append(attempted(name, task, time_limit))
    X = runs["cgff"][0].end.X
    own = None if X is None else solution_at(task, X)
    rows = [judged(scene, task, name, runs[name], own if name != "cgff" else None) for name in names]
    asked = {"repeat": repeat, "time_limit": time_limit}
    return Comparison(scene, asked | options.to_dict(), task.best, tuple(rows))


def chosen(methods: Iterable[str], has_supports: bool) -> list[str]:
    """Return the methods to run, cgff first, each once; raises OptionError for an unknown name."""
    of_free_bodies = {name for name, entry in REGISTRY.items() if entry.is_affine}
    unsuited = of_free_bodies - {"fdm"} if has_supports else {"schek"}
    wanted = ["cgff"]
    for name in methods:
        if name not in (*REGISTRY, "all"):
            raise OptionError(f"unknown method {name!r}; allowed: {', '.join(REGISTRY)}, all")
        wanted += [other for other in REGISTRY if other not in unsuited] if name == "all" else [name]
    told = ["schek" if name == "fdm" and has_supports else name for name in wanted]
    return list(dict.fromkeys(told))


def _task(scene: Scene, options: SolveOptions) -> Task:
    """Return what all methods share, the answer among it; raises KeyboardInterrupt on Ctrl-C."""
    structure = from_scene(scene)
    best = cgff.form_find(structure, replace(options, tolerance=FLOOR, objective="energy"))
    if best.verdict is Verdict.INTERRUPTED:
        raise KeyboardInterrupt
    return Task(structure, scene.owners, options, best, alignment_of(best.shape, structure.free))
