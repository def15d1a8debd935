"""One scene with many sets of numbers: together where a batch is sure of its answers, else in turn."""

from dataclasses import dataclass, replace

import numpy as np

from cgff_cli.analysis.equilibrium import SMALL, stability_of
from cgff_cli.errors import OptionError
from cgff_cli.mechanics.connectivity import DENSE_ENTRIES
from cgff_cli.mechanics.signs import steepest_fall
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.pipeline import METHODS
from cgff_cli.scene.fields import sizes_fit
from cgff_cli.scene.physics import ROUNDING, all_pairs, component_labels
from cgff_cli.scene.scene import AXES, Scene
from cgff_cli.solvers.many.loop import Many
from cgff_cli.solvers.many.signs import BALANCED, NEUTRAL, OPEN, STABLE
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import Structure, from_scene, stiffness

WORDS = {STABLE: "stable", NEUTRAL: "neutral"}


@dataclass(frozen=True, eq=False)
class Solutions:
    """The answers of m rows; units, signs and words are a Result's.

    coordinates : (m, n, d)            forces : (m, b)        energy, residual_relative : (m,)
    verdicts, stability : (m,) words   iterations : (m,)      stability: None where it is not told
    converged, alone    : (m,) bool; alone: solved by itself, not in the batch
    """

    coordinates: np.ndarray
    converged: np.ndarray
    verdicts: np.ndarray
    stability: np.ndarray
    iterations: np.ndarray
    residual_relative: np.ndarray
    energy: np.ndarray
    forces: np.ndarray
    alone: np.ndarray


def solve_many(
    scene: Scene | str,
    *,
    rest_lengths: object = None,
    EA: object = None,
    loads: object = None,
    coordinates: object = None,
    **changes: object,
) -> Solutions:
    """Form-find a scene, or the scene file at a path, once for each row of the arrays given.

    rest_lengths and EA: (m, b), loads and coordinates, the start: (m, n, d), in the scene's own order and
    units; the scene's own where not given. Other keywords are solve options, as in `solve`. Each row gets
    the answer that `solve` gives, and its bytes depend on no other row. Raises OptionError for a bad array.
    """
    if not isinstance(scene, Scene):
        from cgff_cli.scene.read import load

        scene = load(scene)
    options = SolveOptions().merged({**scene.solver, **changes})
    structure = from_scene(scene)
    given = {"rest_lengths": rest_lengths, "EA": EA, "loads": loads, "coordinates": coordinates}
    values = _values(scene, structure, given)
    found = Many(structure, values, options)
    if len(found.known) and _suits(structure, options):
        found.run()
    known = found.known
    answers = Solutions(
        coordinates=found.coordinates,
        converged=known != OPEN,
        verdicts=np.full(len(known), Verdict.CONVERGED.value, dtype=object),
        stability=np.array([WORDS.get(kind) for kind in known.tolist()], dtype=object),
        iterations=found.iterations,
        residual_relative=found.relative,
        energy=found.energy,
        forces=found.forces,
        alone=known == OPEN,
    )
    if options.analysis == "never":
        answers.stability[:] = None
    for row in np.flatnonzero((known == OPEN) | (known == BALANCED)).tolist():
        one = replace(structure, **{name: column[row] for name, column in values.items()})
        _finish(answers, row, one, found.nearly.get(row), options)
    return answers


def _suits(structure: Structure, options: SolveOptions) -> bool:
    """Return whether the batch follows these options, and the structure is small."""
    n, free = len(structure.free), int(structure.free.sum())
    return (
        len(structure.start) * n <= DENSE_ENTRIES
        and 0 < free <= SMALL
        and (options.method, options.objective, options.cg_beta) == ("cgff", "energy", "FR")
        and options.preconditioner in ("auto", "tangent")
    )


def _finish(
    answers: Solutions, row: int, structure: Structure, X: np.ndarray | None, options: SolveOptions
) -> None:
    """Fill in a row by itself: by form_find, unless the batch left it balanced at X (d, m), a minimum."""
    solution = None if X is None else _at(structure, X, options)
    if solution is None:
        solution = METHODS[options.method](structure, options, None)
        if solution.verdict is Verdict.INTERRUPTED:
            raise KeyboardInterrupt
        answers.alone[row] = True
        answers.iterations[row] = solution.iterations
    answers.coordinates[row], answers.forces[row] = solution.coordinates, solution.forces
    answers.converged[row], answers.verdicts[row] = solution.verdict.converged, solution.verdict.value
    answers.residual_relative[row], answers.energy[row] = solution.relative, solution.energy
    answers.stability[row] = stability_of(solution, options).get("stability")


def _at(structure: Structure, X: np.ndarray, options: SolveOptions) -> Solution | None:
    """Return the solution that balances at X (d, m) in its frame; None if K falls there, or tells nothing."""
    mechanics = Mechanics(structure)
    state = mechanics.at(X if mechanics.moves is None else X[:, mechanics.moves])
    solution = Solution(state, Verdict.CONVERGED, options.tolerance, 0)
    told = {"stability": ""} if options.analysis == "never" else stability_of(solution, options)
    return solution if steepest_fall(state) is None and told["stability"] is not None else None


def _values(scene: Scene, structure: Structure, given: dict[str, object]) -> dict[str, np.ndarray]:
    """Return the numbers of all rows, the scene's own where none are given."""
    s = structure
    own = {
        "rest_lengths": s.rest_lengths,
        "EA": np.concatenate([group.EA for group in scene.groups]),
        "loads": s.loads,
        "coordinates": s.coordinates,
    }
    lower = {"rest_lengths": "> 0" if scene.law == "hooke" else ">= 0", "EA": "> 0"}
    arrays = {
        name: _checked(name, value, own[name].shape, lower.get(name, ""))
        for name, value in given.items()
        if value is not None
    }
    counts = {name: len(array) for name, array in arrays.items()}
    if len(set(counts.values())) > 1:
        told = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise OptionError(f"all arrays must have as many rows as there are structures; {told}")
    m = next(iter(counts.values()), 1)
    full = {name: np.broadcast_to(arrays.get(name, value), (m, *value.shape)) for name, value in own.items()}
    if "loads" in arrays:
        _check_net_loads(scene, full["loads"])
    k = stiffness(scene.law, full.pop("EA"), full["rest_lengths"])
    return {**full, "stiffness": k}


def _checked(name: str, value: object, shape: tuple[int, ...], lower: str) -> np.ndarray:
    """Return an array of numbers, a row of the given shape for each structure, or raise OptionError."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise OptionError(f"{name} must be an array of numbers") from None
    if array.shape[1:] != shape or array.ndim != 1 + len(shape):
        wanted = ", ".join(("m", *map(str, shape)))
        raise OptionError(
            f"{name} must have the shape ({wanted}), a row for each of m structures in the scene's own "
            f"order, got {array.shape}"
        )
    if not sizes_fit(array, lower):
        allowed = {
            "> 0": "finite numbers from 1e-30 to 1e30",
            ">= 0": "0 or finite numbers from 1e-30 to 1e30",
        }
        raise OptionError(f"{name} must be {allowed.get(lower, 'finite numbers of at most 1e30 in size')}")
    return array


def _check_net_loads(scene: Scene, loads: np.ndarray) -> None:
    """Raise OptionError for a row whose loads add up along an axis that a part is free to move along.

    loads: (m, n, d). As for a scene's own loads, there is no equilibrium to find.
    """
    labels = component_labels(loads.shape[1], all_pairs(scene.groups))
    for part in range(int(labels.max()) + 1):
        members = np.flatnonzero(labels == part)
        own = loads[:, members]
        net, gross = np.abs(own.sum(axis=1)), np.abs(own).sum(axis=1)
        held = "".join(scene.supports.get(int(row), "") for row in members)
        free = np.array([axis not in held for axis in AXES[: loads.shape[2]]])
        for row, axis in np.argwhere(free & (net > ROUNDING * gross))[:1].tolist():
            raise OptionError(
                f"loads of row {row} (the first is row 0): no equilibrium exists, as they add up along "
                f"{AXES[axis]}, and no support holds the part with node {scene.node_names[members[0]]} there"
            )
