"""The numbers of a scene that a sweep changes: their keys, the values they take, their places in its arrays.

A new kind of key is one entry of OF_GROUPS or OF_NODES. One element is named by its nodes, A,B.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import combinations
from math import isfinite
from typing import Any, NamedTuple

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.many import own_numbers
from cgff_cli.scene.laws import rules
from cgff_cli.scene.nodes import ANY_SIZE
from cgff_cli.scene.scene import AXES, Scene
from cgff_cli.scene.select import chosen_rows
from cgff_cli.structure import from_scene
from cgff_cli.study.load_factors import check_factored, factored_names, in_factored
from cgff_cli.values import Rule, as_number

OF_GROUPS = {"rest_length": "rest_lengths", "EA": "EA", "pretension": "pretension", "weight": "weights"}
OF_NODES = {"nodes": "coordinates", "loads": "loads"}
"""What the last, or the first, word of a key names -> the array of `solve_many` that holds it."""

LOADS, CASE = "loads", "case"
"""What a key calls all loads of the scene, and what stands before the name of a load case."""

KEYS = (
    "GROUP.rest_length, .EA, .pretension or .weight, with A,B for GROUP those of one element, "
    "nodes.NAME.x, loads.NAME.x, case.NAME or, by factors, loads"
)
COUNT = Rule(kind=int, least=1, most=10**7)

Values = str | float | Sequence[float]
"""Values as on the command line, or numbers."""


class Axis(NamedTuple):
    """One swept number.

    array, place : the array of `solve_many` that holds it, and where, in that of one structure
    values       : those it takes in turn; of a random range its two ends
    is_range     : random between two ends, not among values; is_log: its logarithm is uniform there
    is_factor    : multiplies the scene's own numbers
    """

    key: str
    array: str
    place: Any
    values: np.ndarray
    is_range: bool = False
    is_log: bool = False
    is_factor: bool = False

    def at(self, shares: np.ndarray) -> np.ndarray:
        """Return random values, (m,), for uniform shares of [0, 1)."""
        if not self.is_range:
            return self.values[(shares * len(self.values)).astype(int)]
        least, greatest = self.values
        if self.is_log:
            return np.asarray(least * (greatest / least) ** shares)
        return np.asarray(least + (greatest - least) * shares)


def axes(
    scene: Scene, values: Mapping[str, Values], factors: Mapping[str, Values], is_random: bool
) -> tuple[Axis, ...]:
    """Return the axes of a sweep, those of values first; is_random: ranges have no count.

    Raises OptionError for a key that the scene has not, and for values that no scene may have.
    """
    twice = [key for key in factors if key in values]
    if twice:
        raise OptionError(f"{twice[0]} is both set and scaled")
    if not values and not factors:
        raise OptionError(f"nothing is swept; give {KEYS} some values")
    found = []
    for own, is_factor in ((values, False), (factors, True)):
        for key, given in own.items():
            array, place = _place(scene, key, is_factor)
            numbers, is_range, is_log = _values(key, given, is_random)
            found.append(Axis(key, array, place, numbers, is_range, is_log, is_factor))
            _check_values(scene, found[-1])
    _check_together(scene, found)
    return tuple(found)


def numbers_of(scene: Scene) -> dict[str, np.ndarray]:
    """Return a scene's own numbers by array; NaN where a group has no pretension, and for load factors."""
    nothing = (np.full_like(group.EA, np.nan) for group in scene.groups)
    given = zip(scene.groups, nothing, strict=True)
    pretension = [none if group.pretension is None else group.pretension for group, none in given]
    return {
        **own_numbers(scene, from_scene(scene)),
        "pretension": np.concatenate(pretension),
        "factors": np.full(len(factored_names(scene)), np.nan),
    }


def _place(scene: Scene, key: str, is_factor: bool) -> tuple[str, Any]:
    """Return the array and the place in it that a key names; only its ends have a meaning of their own."""
    if key == LOADS:
        if not is_factor:
            raise OptionError(f"{key}: all loads are many numbers; scale them, or set {LOADS}.NAME.x")
        return "loads", (slice(None), slice(None))
    stem, _, last = key.rpartition(".")
    kind, _, node = stem.partition(".")
    if stem == CASE and not (last in OF_GROUPS and any(group.name == CASE for group in scene.groups)):
        if is_factor:
            raise OptionError(f"{key}: is a factor itself; set it")
        scene.in_case(last)
        return "factors", (factored_names(scene).index(last),)
    if last in OF_GROUPS:
        return OF_GROUPS[last], (chosen_rows(scene, stem),)
    if kind in OF_NODES and last in AXES[: scene.dimension]:
        return OF_NODES[kind], (scene.row_of(node), AXES.index(last))
    if kind in OF_NODES and node:
        raise OptionError(f"{key}: an axis of this scene is one of {', '.join(AXES[: scene.dimension])}")
    raise OptionError(f"{key}: no number of a scene; what can be swept: {KEYS}")


def _values(key: str, given: Values, is_random: bool) -> tuple[np.ndarray, bool, bool]:
    """Return values, or ends, (v,); whether they are ends; whether they are even in their logarithm."""
    if not isinstance(given, str):
        numbers = [as_number(value) for value in np.ravel(np.asarray(given, dtype=object)).tolist()]
        if not numbers or None in numbers:
            raise OptionError(f"{key}: values must be numbers, got {given!r}")
        return np.array(numbers, dtype=float), False, False
    words = given.split(":")
    is_log = words[0].strip() == "log"
    words = words[is_log:]
    with suppress(ValueError, OverflowError):
        if len(words) == 1 and not is_log:
            return np.array([float(word) for word in words[0].split(",")]), False, False
        if len(words) == 3 - is_random:
            least, greatest = (float(word) for word in words[:2])
            if not (isfinite(least) and isfinite(greatest) and (not is_log or min(least, greatest) > 0.0)):
                meant = "> 0 where it is logarithmic" if is_log else "finite"
                raise OptionError(f"{key}={given}: both ends of a range must be {meant}")
            if is_random:
                return np.array((least, greatest)), True, is_log
            count = COUNT.checked(f"{key}={given}: the count", int(words[2]))
            with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused later
                return (np.geomspace if is_log else np.linspace)(least, greatest, count), False, is_log
    counted = "" if is_random else ":COUNT"
    meant = f"LEAST:GREATEST{counted}, log:LEAST:GREATEST{counted} or numbers with commas"
    why = "; a random sweep takes no count" if is_random and len(words) == 3 else ""
    raise OptionError(f"{key}={given}: values must be {meant}{why}")


def _check_values(scene: Scene, axis: Axis) -> None:
    """Raise OptionError where a value is none that a scene may have."""
    last, own = axis.key.rpartition(".")[2], numbers_of(scene)[axis.array][axis.place].reshape(-1)
    if axis.array == "factors":
        for name, numbers, rule in in_factored(scene, last):
            _check_made(axis, name, rule, numbers)
        return
    if axis.is_factor and np.isnan(own).any():
        raise OptionError(f"{axis.key}: the group has no pretension to scale")
    if axis.key == LOADS and not own.any():
        raise OptionError(f"{LOADS}: the scene has none to scale; {CASE}.NAME is the factor of a load case")
    kind = scene.groups[scene.owners[axis.place[0][0]]].kind if last in OF_GROUPS else None
    _check_made(axis, last, rules(scene.law, kind).get(last, ANY_SIZE), own if axis.is_factor else None)


def _check_made(axis: Axis, name: str, rule: Rule, own: np.ndarray | None) -> None:
    """Raise OptionError where a value, or what it makes of numbers of its own, breaks a rule."""
    with np.errstate(over="ignore", invalid="ignore"):
        ends = np.array([1.0] if own is None else [own.min(), own.max()])
        made = axis.values[:, None] * ends
    bad = np.argwhere(~(rule.fits(made) & np.isfinite(made)))[:1].tolist()
    for row, end in bad:
        number = float(made[row, end])
        got = f"{number:g}" + (f" for the factor {axis.values[row]:g}" if own is not None else "")
        fault = rule.fault(number, got) if isfinite(number) else f"must be a finite number, got {got}"
        raise OptionError(f"{axis.key}: {name} {fault}")


def _check_together(scene: Scene, found: Sequence[Axis]) -> None:
    """Raise OptionError where axes have no meaning together, or one undoes what a column tells of another."""
    names, numbers = factored_names(scene), numbers_of(scene)
    check_factored(scene, [names[axis.place[0]] for axis in found if axis.array == "factors"])
    for a, b in combinations(found, 2):
        held = [np.zeros_like(numbers[axis.array], dtype=bool) for axis in (a, b)]
        held[0][a.place] = held[1][b.place] = True
        if a.array == b.array and not (a.is_factor and b.is_factor) and (held[0] & held[1]).any():
            raise OptionError(f"{a.key} and {b.key} change the same number; only factors may do so together")
