"""One scene with many sets of numbers: together where a batch is sure of its answers, else in turn."""

from dataclasses import replace

import numpy as np

from cgff_cli.analysis.equilibrium import stability_of
from cgff_cli.errors import OptionError
from cgff_cli.mechanics.connectivity import DENSE_ENTRIES
from cgff_cli.options import DEFAULTS, SolveOptions
from cgff_cli.pipeline import METHODS
from cgff_cli.scene.laws import rules
from cgff_cli.scene.nodes import ANY_SIZE
from cgff_cli.scene.physics import ROUNDING, all_pairs, component_labels
from cgff_cli.scene.scene import AXES, Scene
from cgff_cli.solvers.many.loop import Loop, Solutions
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import Structure, from_scene, loads_of, stiffness, weight_at_nodes
from cgff_cli.values import Rule, short


def solve_many(
    scene: Scene | str,
    *,
    rest_lengths: object = None,
    EA: object = None,
    loads: object = None,
    coordinates: object = None,
    weights: object = None,
    **changes: object,
) -> Solutions:
    """Form-find a scene, or the scene file at a path, once for each row of the arrays given.

    rest_lengths, EA and weights, per rest length: (m, b), loads besides weight and coordinates, the start:
    (m, n, d), in the scene's own order and units; the scene's own where not given. Other keywords are
    solve options, as in `solve`. Near an answer each row gets the one that `solve` gives, from wild starts
    maybe another that is as sure; its bytes depend on no other row. Raises OptionError for a bad array.
    """
    if not isinstance(scene, Scene):
        from cgff_cli.scene.read import load

        scene = load(scene)
    options = DEFAULTS.merged({**scene.solver, **changes})
    structure = from_scene(scene)
    given = {"rest_lengths": rest_lengths, "EA": EA, "loads": loads, "coordinates": coordinates}
    given["weights"] = weights
    values = _values(scene, structure, {name: value for name, value in given.items() if value is not None})
    m = len(values["loads"])
    answers = Solutions(
        coordinates=np.array(values["coordinates"]),
        converged=np.ones(m, dtype=bool),
        verdicts=np.full(m, Verdict.CONVERGED.value, dtype=object),
        stability=np.full(m, None, dtype=object),
        iterations=np.zeros(m, dtype=int),
        residual_relative=np.zeros(m),
        energy=np.zeros(m),
        forces=np.zeros_like(values["stiffness"]),
        alone=np.ones(m, dtype=bool),
    )
    if _suits(structure, options):
        Loop(structure, values, options, answers).run()
    if options.analysis == "never":
        answers.stability[:] = None
    for row in np.flatnonzero(answers.alone).tolist():
        one = replace(structure, **{name: column[row] for name, column in values.items()})
        _solve_alone(answers, row, one, options)
    return answers


def _suits(structure: Structure, options: SolveOptions) -> bool:
    """Return whether the batch follows these options, and the structure is small."""
    n, free = len(structure.free), int(structure.free.sum())
    return (
        len(structure.start) * n <= DENSE_ENTRIES
        and free > 0
        and (options.method, options.objective, options.cg_beta) == ("cgff", "energy", "FR")
        and options.preconditioner in ("auto", "tangent")
    )


def _solve_alone(answers: Solutions, row: int, structure: Structure, options: SolveOptions) -> None:
    """Fill in a row by form_find from its own start."""
    solution = METHODS[options.method](structure, options, None)
    if solution.verdict is Verdict.INTERRUPTED:
        raise KeyboardInterrupt
    answers.coordinates[row], answers.forces[row] = solution.coordinates, solution.forces
    answers.converged[row], answers.verdicts[row] = solution.verdict.converged, solution.verdict.value
    answers.residual_relative[row], answers.energy[row] = solution.relative, solution.energy
    answers.iterations[row] = solution.iterations
    if solution.verdict.converged and options.analysis != "never":
        answers.stability[row] = stability_of(solution, options)["stability"]


def own_numbers(scene: Scene, structure: Structure) -> dict[str, np.ndarray]:
    """Return the scene's own numbers, by the names and in the shapes that `solve_many` takes a row of."""
    return {
        "rest_lengths": structure.rest_lengths,
        "EA": scene.axial_stiffness,
        "loads": loads_of(scene),
        "coordinates": structure.coordinates,
        "weights": np.zeros_like(structure.rest_lengths) if scene.weights is None else scene.weights,
    }


def _values(scene: Scene, s: Structure, given: dict[str, object]) -> dict[str, np.ndarray]:
    """Return the numbers of all rows, the scene's own where none are given."""
    own = own_numbers(scene, s)
    law = rules(scene.law)
    may_be = {"rest_lengths": law["rest_length"], "EA": law["EA"], "weights": law["weight"]}
    arrays = {
        name: _checked(name, value, own[name].shape, may_be.get(name, ANY_SIZE))
        for name, value in given.items()
    }
    counts = {name: len(array) for name, array in arrays.items()}
    if len(set(counts.values())) > 1:
        told = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise OptionError(f"all arrays must have as many rows as there are structures; {told}")
    m = next(iter(counts.values()), 1)
    full = {name: np.broadcast_to(arrays.get(name, value), (m, *value.shape)) for name, value in own.items()}
    full["loads"] = total_loads(scene, s, full)
    if "loads" in arrays or "weights" in arrays:
        _refuse_net_loads(scene, s.free, full["loads"])
    del full["weights"]
    return full | {"stiffness": stiffness(scene.law, full.pop("EA"), full["rest_lengths"])}


def _checked(name: str, value: object, shape: tuple[int, ...], rule: Rule) -> np.ndarray:
    """Return an array of numbers, a row of the given shape for each structure, or raise OptionError."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise OptionError(f"{name} must be an array of numbers") from None
    if array.ndim != 1 + len(shape) or array.shape[1:] != shape:
        raise OptionError(
            f"{name} must have the shape ({', '.join(('m', *map(str, shape)))}), a row for each of m "
            f"structures in the scene's own order, got {array.shape}"
        )
    if not np.all(rule.fits(array)):
        most, zero = short(rule.largest), "" if rule.positive else "0 or "
        sizes = f"{zero}finite numbers from {short(rule.smallest)} to {most}"
        any_size = f"finite numbers of at most {most} in size"
        raise OptionError(f"{name} must be {sizes if rule.smallest else any_size}")
    return array


def total_loads(scene: Scene, structure: Structure, values: dict[str, np.ndarray]) -> np.ndarray:
    """Return (m, n, d) loads with weight, of arrays by the names of `own_numbers`."""
    weights, loads = values["weights"], values["loads"]
    if not weights.any():
        return loads
    weight = weights * values["rest_lengths"]
    return loads + np.array([weight_at_nodes(structure, own, scene.down) for own in weight])


def net_loads(scene: Scene, free: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Return (m, parts, d) bool: where loads, (m, n, d), add up along an axis that a part is free along."""
    labels = component_labels(len(free), all_pairs(scene.groups))
    parts = (labels == np.arange(labels.max() + 1)[:, None]).astype(float)
    net, gross = np.abs(parts @ loads), parts @ np.abs(loads)
    return (parts @ ~free == 0.0) & (net > ROUNDING * gross)


def _refuse_net_loads(scene: Scene, free: np.ndarray, loads: np.ndarray) -> None:
    labels = component_labels(len(free), all_pairs(scene.groups))
    for row, part, axis in np.argwhere(net_loads(scene, free, loads))[:1].tolist():
        raise OptionError(
            f"loads of row {row} (the first is row 0): no equilibrium exists, as they add up along "
            f"{AXES[axis]}, and no support holds the part with node "
            f"{scene.node_names[(labels == part).argmax()]} there"
        )
