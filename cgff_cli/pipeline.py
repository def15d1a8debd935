"""Scene in, result out: the walk through the rooms, in order."""

from dataclasses import replace
from time import perf_counter
from typing import Any

from cgff_cli.analysis.equilibrium import analysed, unanalysed
from cgff_cli.analysis.reasons import INTERRUPTED
from cgff_cli.options import DEFAULTS, SolveOptions
from cgff_cli.result import Result
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers import cgff, table1
from cgff_cli.solvers.solution import Observer, Solution
from cgff_cli.structure import from_scene

METHODS = {"cgff": cgff.form_find, "table1": table1.form_find}


def solve(scene: Scene | str, *, observer: Observer | None = None, **changes: object) -> Result:
    """Form-find a scene, or the scene file at a path, and return its Result.

    Keywords are solve options (see SolveOptions) and win over the scene's own. `observer` is called with
    one history row per iteration. Raises SceneError for a bad file, OptionError for a bad option; a run
    that reaches no equilibrium, or is interrupted, is a Result that says so.
    """
    if not isinstance(scene, Scene):
        from cgff_cli.scene.read import load

        scene = load(scene)
    options = DEFAULTS.merged({**scene.solver, **changes})
    structure = from_scene(scene)
    start = perf_counter()
    solution = METHODS[options.method](structure, options, observer)
    seconds = perf_counter() - start
    found = None if options.analysis == "never" else _analysed(scene, solution, options)
    return Result(scene, structure, options, solution, seconds, *(found or (None,)))


def analysed_in_full(result: Result) -> Result:
    """Return a result again, with the ranks and eigenvalues that a large scene's does without."""
    options = result.solve_options.merged({"analysis": "always"})
    analysis, cut_short = _analysed(result.source, result.solution, options)
    return replace(result, solve_options=options, found=analysis, analysis_interrupted=cut_short)


def _analysed(scene: Scene, solution: Solution, options: SolveOptions) -> tuple[dict[str, Any], bool]:
    """Return the analysis, and whether Ctrl-C cut it short: the solution before it stands all the same."""
    try:
        return analysed(scene, solution, options), False
    except KeyboardInterrupt:
        return unanalysed(scene, solution, INTERRUPTED), True
