"""The inverse problem: coordinates in, a self-stress of the right signs and rest lengths out."""

from dataclasses import dataclass, field, replace

import numpy as np

from cgff_cli.analysis.balanced import balanced, least_limit, most_of
from cgff_cli.analysis.blame import blamed
from cgff_cli.analysis.near_shape import near_shape
from cgff_cli.analysis.nulls import DENSE
from cgff_cli.analysis.ranks import LEAST_TOLERANCE
from cgff_cli.analysis.self_stress import SelfStress
from cgff_cli.errors import OptionError
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import largest
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.scene.laws import rest_lengths_for
from cgff_cli.structure import Structure

STRAIN = 0.01
"""Greatest strain of a cable, where no force is asked for."""

SIGNED = 1e-9
"""Share of the greatest force density, or force where that is shared, below which a sign is rounding."""

SAME_FORCE = 1e-5
"""Relative difference within which a force is what was asked for: the digits that a page shows."""

LEAST_STRAIN = 4.0 * EPS
"""Strain below which a rest length, as a double, does not tell the force it is for."""


@dataclass(frozen=True, eq=False)
class Question:
    """What is asked of a shape with b elements.

    EA        : (b,)              law   : "paper" or "hooke"
    classes   : (b,) int, members of one class share a force density, or a force; None: each has its own
    members   : (b,) bool, those whose greatest force is to be `force`, instead of STRAIN; None: of none
    tolerance : singular values up to it count as zero; above LEAST_TOLERANCE the shape may give way
    """

    structure: Structure
    EA: np.ndarray
    law: str
    classes: np.ndarray | None = None
    equal_force: bool = False
    members: np.ndarray | None = None
    force: float = 0.0
    tolerance: float = LEAST_TOLERANCE

    @property
    def limits(self) -> np.ndarray:
        """(b,) the size of force at which an element is as strained, or forced, as asked; else infinity."""
        s = self.structure
        if self.members is not None:
            return np.where(self.members, self.force, np.inf)
        cables = s.tension_only
        strain = np.where(cables, STRAIN, -STRAIN)
        stretched = self.EA * (s.rest_lengths / (1.0 + strain) if self.law == "paper" else 1.0)
        return np.where(cables | (not cables.any()), STRAIN * stretched, np.inf)

    def strain_at(self, times: float) -> float:
        """Return the size of strain at `times` the force of STRAIN; infinity where l0 would be 0."""
        strain = STRAIN if self.structure.tension_only.any() else -STRAIN
        left = 1.0 + strain * (1.0 - times) if self.law == "paper" else 1.0
        return STRAIN * times / left if left > 0.0 else np.inf

    def rest_lengths(self, l: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Return (b,) l0 at which lengths l give forces t; NaN where none does, or none above 0."""
        return rest_lengths_for(self.law, l, t, self.EA)


@dataclass(eq=False)
class Answer:
    """What came of a question; arrays are (b,), in the user's units.

    why           : "" where feasible, else: no_state, no_group_state, no self-stress at all, or none of
                    shared values; signs, none of the right ones; loads, none that bears them; rest_length,
                    none above 0; force, no such greatest one under the loads; inexact, none but to the
                    tolerance; weight, none found that bears its own; blurred, undecided: rounding decides
    states, group_states, mechanisms : counts, None where not told; group_states of shared values
    gap, softest  : least singular value kept over the greatest left out; the least of all
    never, idle   : bool      motion : (n, d), what proves who is to blame, or None
    forces, force_densities, rest_lengths      coordinates : (n, d) the shape that they hold
    strain_needed : cable strain that the loads alone need, where that is above STRAIN
    force_reached : greatest force that could be, where another was asked for
    left_over     : what is left of the forces of the best state, or of the loads, relative to all
    is_given      : rest lengths are those that the scene came with
    """

    structure: Structure
    why: str = ""
    states: int | None = None
    group_states: int | None = None
    mechanisms: int | None = None
    gap: float | None = None
    softest: float | None = None
    never: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    idle: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    motion: np.ndarray | None = None
    forces: np.ndarray = field(default_factory=lambda: np.zeros(0))
    force_densities: np.ndarray = field(default_factory=lambda: np.zeros(0))
    rest_lengths: np.ndarray | None = None
    coordinates: np.ndarray | None = None
    strain_needed: float | None = None
    force_reached: float | None = None
    left_over: float = 0.0
    is_given: bool = False


def prestressed(question: Question) -> Answer:
    """Return forces and rest lengths that hold a shape, or why there are none.

    The structure's rest lengths are its lengths. Raises OptionError where a tolerance is asked of a
    structure too large for it.
    """
    structure, tolerance = question.structure, question.tolerance
    mechanics = Mechanics(structure)
    state = mechanics.at(mechanics.start)
    answer = Answer(structure)
    whole = balance = SelfStress(state, None, False, tolerance)
    answer.states = whole.states
    if whole.rank is not None:
        answer.mechanisms = whole.A.shape[0] - state.rigid.basis.shape[1] - whole.rank
    if question.classes is not None:
        balance = SelfStress(state, question.classes, question.equal_force, tolerance)
        answer.group_states = balance.states
    if tolerance > LEAST_TOLERANCE and not whole.is_dense:
        raise OptionError(f"tolerance needs a structure of at most {DENSE} elements or free directions")
    answer.gap, answer.softest, answer.left_over = balance.gap, balance.softest, balance.unborne
    signs = np.zeros(len(balance.size))
    signs[balance.classes] = np.where(structure.tension_only, 1.0, -1.0)
    x = _best(question, answer, balance, signs) if balance.states != 0 or balance.is_loaded else None
    if answer.why == "force" and tolerance == LEAST_TOLERANCE:
        _check_force(question, answer, balance)
    elif not answer.why and (x is None or not _is_signed(balance, x, signs)):
        _blame(answer, balance, signs)
    if answer.why or x is None:
        return answer
    if tolerance > LEAST_TOLERANCE:
        balance, x = near_shape(balance, x)
    answer.left_over = balance.left_over(x)
    if balance.is_met(x) and _is_signed(balance, x, signs):
        _realise(question, answer, balance, x)
    else:
        answer.why = "inexact"
    return answer


def _check_force(question: Question, answer: Answer, balance: SelfStress) -> None:
    """Withdraw that a force cannot be where what is left over of the loads may be all that forbids it."""
    short = abs((answer.force_reached or 0.0) - question.force) / balance.state.mechanics.frame.force
    if not balance.tells(question.members, short):
        answer.why = "inexact"


def _best(question: Question, answer: Answer, balance: SelfStress, signs: np.ndarray) -> np.ndarray | None:
    """Return the best x, of whatever signs; None where no x bears the loads."""
    most = np.ones(len(signs))
    if balance.is_loaded:
        limits = question.limits / (balance.share * balance.state.mechanics.frame.force)
        most = np.full(len(signs), np.inf)
        np.minimum.at(most, balance.classes, limits)
        need = least_limit(balance, signs, most)
        if need is None:
            return None
        if need > 1.0 + SAME_FORCE and question.members is not None:
            answer.why, answer.force_reached = "force", need * question.force
            return None
        if question.members is not None:
            most = most * max(1.0, need * (1.0 + SAME_FORCE))
        elif need > 1.0:
            answer.strain_needed = question.strain_at(need)
            most = most * (2.0 * need)
    x = balanced(balance, signs, most)
    if balance.is_loaded and question.members is not None:
        return _raised(question, answer, balance, signs, most, x)
    return x


def _sizes(balance: SelfStress, x: np.ndarray) -> np.ndarray:
    return np.abs(x / balance.size)


def _raised(
    question: Question,
    answer: Answer,
    balance: SelfStress,
    signs: np.ndarray,
    most: np.ndarray,
    x: np.ndarray,
) -> np.ndarray | None:
    """Return x, moved towards what does the most for the members asked for, as far as their force asks."""
    asked, values, far = np.isfinite(most), _sizes(balance, x), x
    if (values * (1.0 + 2.0 * SAME_FORCE) >= most).any():
        return x
    if not balance.idle()[asked].all():
        far = balanced(balance, signs, 2.0 * most, asked)
    reached = _sizes(balance, far)
    if far is not x and not (asked & (reached >= most)).any():
        far = most_of(balance, signs, most, asked)
        reached = _sizes(balance, far)
    passing = asked & (reached >= most) & (signs * far > 0.0)
    if passing.any():
        return x + (far - x) * float(((most - values)[passing] / (reached - values)[passing]).min())
    share = float((np.maximum(reached, values) / most).max())
    answer.why, answer.force_reached = "force", question.force * share
    return None


def _is_signed(balance: SelfStress, x: np.ndarray, signs: np.ndarray) -> bool:
    values = x / balance.size
    return float((signs * values).min()) > SIGNED * largest(values)


def _realise(question: Question, answer: Answer, balance: SelfStress, x: np.ndarray) -> None:
    """Set the forces of x, to the level asked for, and what follows from them."""
    state, frame = balance.state, balance.state.mechanics.frame
    if question.tolerance > LEAST_TOLERANCE:
        X, l = frame.centre + state.mechanics.shape(state.X), state.l * frame.length
        question = replace(question, structure=replace(question.structure, coordinates=X, rest_lengths=l))
    s, t = question.structure, balance.forces(x) * frame.force
    if not balance.is_loaded:
        t = t * float((question.limits / np.abs(t)).min())
    answer.coordinates, answer.forces, answer.force_densities = s.coordinates, t, t / s.rest_lengths
    answer.rest_lengths = question.rest_lengths(s.rest_lengths, t)
    if np.isnan(answer.rest_lengths).any():
        answer.why = "rest_length"
    elif (np.abs(s.rest_lengths - answer.rest_lengths) < LEAST_STRAIN * s.rest_lengths).any():
        answer.why = "blurred"


def _blame(answer: Answer, balance: SelfStress, signs: np.ndarray) -> None:
    """Set who is to blame for the lack of a state of the right signs, and what proves it."""
    found = blamed(balance, signs)
    if found.proven and found.loads:
        answer.why = "loads"
    elif not found.proven:
        answer.why = "undecided"
    elif balance.states == 0 and not balance.is_loaded:
        answer.why = "no_group_state" if answer.states else "no_state"
    else:
        answer.why = "signs"
    if not found.proven:
        return
    answer.never, answer.idle = found.never[balance.classes], balance.idle()[balance.classes]
    motion = np.zeros_like(answer.structure.free.T, dtype=float)
    motion[answer.structure.free.T] = found.motion
    answer.motion = motion.T + 0.0  # no zero has a sign
