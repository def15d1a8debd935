"""A shape whose forces balance, and the scene that has it for an answer.

A family of scenes is written down from its answer: coordinates and force densities come first, and rest
lengths follow from them by the elastic law.
"""

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, NamedTuple

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.scene.laws import rest_lengths_for
from cgff_cli.scene.scene import AXES, KINDS, LAWS, Group, Scene
from cgff_cli.values import Rule

_ALIKE = 1e-11  # lengths this near, relatively, are one length and its rounding

Prestress = Annotated[float, Rule("tension of the tightest cable", positive=True)]
"""The parameter by which families without loads scale their self-stress; see `tightened`."""

Weight = Annotated[float, Rule("of all elements per rest length, downwards, put on afterwards", least=0)]
"""The parameter of families that something holds."""


class Members(NamedTuple):
    """One group: pairs (m, 2) of node rows and the force density (m,) each has in equilibrium."""

    name: str
    kind: str
    pairs: np.ndarray
    q: np.ndarray


@dataclass(frozen=True)
class Equilibrium:
    """A shape in balance: under `loads` and held by `supports`, the members' forces add up to zero.

    coordinates : (n, d)                     supports : node row -> axes held fixed
    weight      : of all elements per rest length, which the shape does not balance either
    start       : (n, d) where a solve begins, the coordinates themselves where None
    added_loads : further loads, which the shape does not balance: the answer is then another shape
    added       : what is to be known of them
    answer      : what is known of the shape beyond the lengths and forces of its groups
    """

    title: str
    node_names: Sequence[str]
    coordinates: np.ndarray
    members: Sequence[Members]
    answer: str
    supports: Mapping[int, str] = field(default_factory=dict)
    loads: Mapping[int, tuple[float, ...]] = field(default_factory=dict)
    added_loads: Mapping[int, tuple[float, ...]] = field(default_factory=dict)
    added: str = ""
    weight: float = 0.0
    start: np.ndarray | None = None

    def lengths(self, members: Members) -> np.ndarray:
        """Return (m,) lengths; those of one group that differ by rounding alone are made equal."""
        X, pairs = self.coordinates, members.pairs
        l = np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)
        middle = float(np.median(l))
        return np.full_like(l, middle) if np.ptp(l) <= _ALIKE * middle else l

    def forces(self, members: Members) -> np.ndarray:
        """Return (m,) forces, tension > 0."""
        return members.q * self.lengths(members)


def members(name: str, kind: str, pairs: object, q: object) -> Members:
    """Return a group; `q` is one force density or one per pair."""
    rows = np.array(pairs, dtype=np.intp).reshape(-1, 2)
    return Members(name, kind, rows, np.array(np.broadcast_to(np.asarray(q, dtype=float), len(rows))))


def tightened(target: Equilibrium, prestress: float) -> Equilibrium:
    """Return the same shape with its self-stress scaled so that the tightest cable carries `prestress`."""
    cables = [own for own in target.members if own.kind == KINDS[0]]
    factor = prestress / max(float(target.forces(own).max()) for own in cables)
    scaled = tuple(own._replace(q=own.q * factor) for own in target.members)
    return replace(target, members=scaled)


def realised(
    target: Equilibrium,
    *,
    name: Annotated[str | None, Rule("name of the scene; default: what the family calls it")] = None,
    law: Annotated[str, Rule("elastic law", choices=LAWS)] = "hooke",
    EA: Annotated[float, Rule("axial stiffness of cables", positive=True)] = 1000.0,
    strut_EA: Annotated[
        float | None, Rule("axial stiffness of struts; default: ten times EA", positive=True)
    ] = None,
    noise: Annotated[
        float,
        Rule("start off by up to this times the mean element length, supports excepted", least=0, most=1e6),
    ] = 0.0,
    jitter: Annotated[float, Rule("rest lengths off by up to this fraction", least=0, most=0.9)] = 0.0,
    seed: Annotated[int, Rule("seed of noise and jitter", least=0)] = 0,
) -> Scene:
    """Return the scene whose rest lengths make the target its equilibrium.

    Same arguments, same scene: randomness is Python's own generator, whose numbers are the same on every
    machine. Raises OptionError where a member cannot carry its force.
    """
    stiffness = {KINDS[0]: EA, KINDS[1]: strut_EA or 10.0 * EA}
    groups = [_group(target, own, law, stiffness[own.kind]) for own in target.members]
    if jitter:
        groups = _jittered(groups, jitter, random.Random(f"jitter {seed}"))
    return Scene(
        name=name or target.title,
        law=law,
        node_names=tuple(target.node_names),
        coordinates=_start(target, noise, random.Random(f"noise {seed}")),
        groups=tuple(groups),
        supports=dict(target.supports),
        loads={**target.loads, **target.added_loads},
    )


def _group(target: Equilibrium, own: Members, law: str, EA: float) -> Group:
    """Return a group that carries its forces."""
    l, t = target.lengths(own), target.forces(own)
    rest = rest_lengths_for(law, l, t, np.full(len(l), EA))
    if not np.all(rest > 0.0):
        worst = float(t[np.argmax(np.abs(t))])
        raise OptionError(
            f"no rest length gives {own.name} a force of {worst:.6g} with EA {EA:g}; "
            "lower the force or raise EA"
        )
    weight = np.full(len(l), target.weight) if target.weight else None
    return Group(own.name, own.kind, own.pairs, np.full(len(l), EA), rest, weight=weight)


def _jittered(groups: list[Group], jitter: float, source: random.Random) -> list[Group]:
    return [
        replace(group, rest_length=group.rest_length * (1.0 + jitter * _uniform(source, len(group.EA))))
        for group in groups
    ]


def _start(target: Equilibrium, noise: float, source: random.Random) -> np.ndarray:
    X = np.array(target.coordinates if target.start is None else target.start, dtype=float)
    if noise:
        reach = noise * float(np.concatenate([target.lengths(own) for own in target.members]).mean())
        offsets = reach * _uniform(source, X.size).reshape(X.shape)
        for row, axes in target.supports.items():
            offsets[row, [AXES.index(axis) for axis in axes]] = 0.0
        X += offsets
    return X + 0.0  # no negative zeros


def _uniform(source: random.Random, count: int) -> np.ndarray:
    """Return (count,) numbers from -1 to 1."""
    draw = source.random
    return 2.0 * np.array([draw() for _ in range(count)]) - 1.0
