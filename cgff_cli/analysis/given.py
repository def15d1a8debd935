"""All that is told of coordinates as given: what a solve tells, and what it leaves to be asked for."""

from functools import cached_property
from typing import Any

import numpy as np

from cgff_cli.analysis.buckling import NEVER, critical_load_factor, moved_by_loads
from cgff_cli.analysis.equilibrium import analysed, carries, labels, stability_of
from cgff_cli.analysis.mechanisms import mechanisms_of
from cgff_cli.analysis.modes import by_nodes, modes_of, spectrum_of
from cgff_cli.analysis.ranks import Ranks
from cgff_cli.analysis.reasons import ALL_IDLE, NOT_BALANCED, OF_EQUILIBRIA, OF_LOADS
from cgff_cli.analysis.sensitivity import Sensitivity, unit_response
from cgff_cli.analysis.slackening import first_slack, slack_words
from cgff_cli.analysis.stability import LEAST, Signs, resists
from cgff_cli.mechanics.state import State
from cgff_cli.options import SolveOptions
from cgff_cli.scene.scene import Scene
from cgff_cli.scene.select import chosen_rows
from cgff_cli.solvers.solution import Solution

MAIN, MOST_MAIN = 0.5, 6
"""Share of a shape's largest motion from which a node is a main one of it, and how many are named."""

GEOMETRY = "a geometry has no rest lengths, and so no forces and no stiffness; cgff prestress finds some"
_COUNT_UNSURE = "not told: rounding in the factors of K hides the signs of some eigenvalues"
_STRESS_UNSURE = "not told: along some mechanism rounding hides the sign of what stress resists"
_MANY = "not told: the structure is large and not stable, and its mechanisms are not known one by one"
_NOT_FOUND = "not told: the softest motions of a structure of this size were not found"
OF_FORCES = (
    *("nullity_D", "condition_D", *OF_EQUILIBRIA, *OF_LOADS),
    *("prestressed", "slack_count", "slack_cables", "struts_in_tension_count", "struts_in_tension"),
)

Mode = dict[str, Any]
Told = dict[str, tuple[Any, str]]
"""Field -> value, and why it is null where it is."""


class Given:
    """A shape as given, and its tangent stiffness; where forces balance, brought down to rounding.

    solution: of no steps; count: how many modes of either kind are wanted
    """

    def __init__(self, scene: Scene, solution: Solution, options: SolveOptions, count: int):
        self.scene, self.solution, self.count = scene, solution, count
        self.options = options.merged({"analysis": "always"})
        self.balanced, self.floor = solution.verdict.converged, solution.balance.floor
        self.judged: tuple[State, np.ndarray, Signs] | None = None
        self._kept: dict[bytes, Signs] = {}

    def signs_of(self, state: State, taut: np.ndarray, floor: float) -> Signs:
        """Return the spectrum of K at a state, made once; the last asked for is that of the state judged."""
        key = state.X.tobytes()
        if key not in self._kept:
            count = max(self.count, LEAST)
            self._kept[key] = spectrum_of(state, taut, floor, self.options.factor, count)
        self.judged = state, taut, self._kept[key]
        return self._kept[key]

    @cached_property
    def base(self) -> dict[str, Any]:
        """What a solve tells."""
        return analysed(self.scene, self.solution, self.options, self.signs_of)

    @cached_property
    def tangent(self) -> tuple[State, np.ndarray, Signs]:
        """The state that is judged, (b,) bool which elements resist there, and the signs of K."""
        if self.balanced and self.judged is None:
            stability_of(self.solution, self.options, float("inf"), self.signs_of)
        if self.judged:
            return self.judged
        state = self.solution.state
        taut = resists(state, self.floor) if self.balanced else state.taut
        return state, taut, self.signs_of(state, taut, self.floor)

    @property
    def doubt(self) -> float:
        """The size of a stiffness that has no sign; out of balance the shape stands for itself."""
        signs = self.tangent[2]
        return signs.doubt if self.balanced else signs.blurred

    def analysis(self) -> dict[str, Any]:
        """Return the `analysis` object with every field, null for a reason it tells."""
        if self.scene.is_geometry:
            return self._without_forces()
        stress, mechanisms = self._mechanisms()
        told, softest = self._stiffness()
        if self.base["prestress_stable"] is None and self.balanced:
            told["prestress_stable"] = self._resisted(stress)
        modes = [*mechanisms, *softest] if softest is not None else None
        return _with(self.base, told | {"modes": (modes, _NOT_FOUND)})

    def _without_forces(self) -> dict[str, Any]:
        """Return the same of a geometry: states and mechanisms."""
        modes = [mode | {"stiffness": None} for mode in self._mechanisms()[1]]
        told: Told = dict.fromkeys(OF_FORCES, (None, GEOMETRY))
        return _with(self.base, told | {"modes": (modes, "")})

    def sensitivity(self, of: str) -> Sensitivity:
        """Return what a unit of rest length in a group, or in the element that joins A,B, does.

        Raises OptionError where there is no such group or element.
        """
        rows = chosen_rows(self.scene, of)
        if self.scene.is_geometry:
            return Sensitivity(None, None, GEOMETRY)
        if not self.balanced:
            return Sensitivity(None, None, NOT_BALANCED)
        return unit_response(*self.tangent, rows, self.scene.law == "hooke", self.doubt)

    def _stiffness(self) -> tuple[Told, list[Mode] | None]:
        """Return what K tells, and its softest motions, None where they were not found."""
        state, _, signs = self.tangent
        values, shapes, is_found = modes_of(signs, state, max(self.count, LEAST))
        told: Told = {
            "smallest_stiffness": (float(values[0]) if len(values) else None, ALL_IDLE),
            "tangent_eigenvalues": (values[:LEAST].tolist() if is_found else None, _NOT_FOUND),
            "negative_eigenvalues": (signs.counted(self.doubt), _COUNT_UNSURE),
        }
        told |= self._under_loads()
        return told, self._named("softest", values, shapes) if is_found else None

    def _under_loads(self) -> Told:
        """Return what more of the loads would do."""
        if not self.balanced:
            return dict.fromkeys(OF_LOADS, (None, NOT_BALANCED))
        state, taut, signs = self.tangent
        dx, why = moved_by_loads(state, signs, self.doubt)
        if dx is None:
            return dict.fromkeys(OF_LOADS, (None, why))
        slack, rows, none = first_slack(state, taut, signs, self.doubt, dx)
        cables = labels(self.scene, rows) or None
        factor, why = critical_load_factor(state, signs, self.doubt, dx)
        if why == NEVER and cables and slack:
            why += f" and no cable goes slack; {slack_words(cables, slack)}"
        return dict(zip(OF_LOADS, ((factor, why), (slack, none), (cables, none)), strict=True))

    def _mechanisms(self) -> tuple[np.ndarray | None, list[Mode]]:
        """Return what stress resists along mechanisms, (m,), None in large ones; and the softest of these."""
        state = self.solution.state
        if self.base["mechanisms"] is None or not state.mechanics.is_small:
            return None, []
        values, shapes = mechanisms_of(Ranks(state, self.base["rank_tolerance"]))
        scaled = values * state.mechanics.frame.stiffness
        return values, self._named("mechanism", scaled, by_nodes(state, shapes[: self.count]))

    def _resisted(self, stress: np.ndarray | None) -> tuple[bool | None, str]:
        """Return whether stress resists every mechanism; stress: what `_mechanisms` returns."""
        state = self.solution.state
        if stress is None:
            return None, _MANY if self.base["mechanisms"] else self.base["reason"]["mechanisms"]
        if not carries(state, self.floor) or stress[0] < -self.doubt:
            return False, ""
        return True if stress[0] > self.doubt else None, _STRESS_UNSURE

    def _named(self, kind: str, values: np.ndarray, shapes: np.ndarray) -> list[Mode]:
        """Return motions, (m, n, d), as records of nodes by name."""
        names, found = self.scene.node_names, []
        for value, shape in zip(values[: self.count].tolist(), shapes, strict=False):
            size = np.linalg.norm(shape, axis=1)
            order = np.argsort(-(size / (size.max() or 1.0)).round(6), kind="stable")[:MOST_MAIN]
            main = [names[row] for row in order.tolist() if size[row] >= MAIN * size[order[0]]]
            by_name = dict(zip(names, shape.tolist(), strict=True))
            found.append({"kind": kind, "stiffness": value, "shape": by_name, "main_nodes": main})
        return found


def _with(base: dict[str, Any], told: Told) -> dict[str, Any]:
    """Return an analysis with more fields told, and why they are null where they are."""
    reason = {name: why for name, why in base["reason"].items() if name not in told}
    reason |= {name: why for name, (value, why) in told.items() if value is None}
    return base | {name: value for name, (value, _) in told.items()} | {"reason": reason}
