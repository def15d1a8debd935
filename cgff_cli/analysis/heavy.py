"""Prestress of elements with weight, which hangs on the rest lengths that are asked for."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from cgff_cli.analysis.prestress import Answer, Question, prestressed
from cgff_cli.analysis.ranks import LEAST_TOLERANCE
from cgff_cli.analysis.self_stress import SelfStress
from cgff_cli.mechanics.state import Mechanics

SAME_LENGTH = 1e-14
"""Relative difference within which two rest lengths are one and its rounding."""

WEIGHED = 8
"""Times that weight follows rest lengths: each gains the digits of a weight over EA."""

_UNBORNE = ("loads", "signs", "undecided")
"""Why no state bears loads, or seems to bear them, if they are just these."""

LoadsOf = Callable[[np.ndarray], np.ndarray]
"""Rest lengths (b,) -> loads and their weight (n, d)."""


def heavy(question: Question, loads: LoadsOf, answer: Answer) -> Answer:
    """Return the answer to the weight of its own rest lengths; answer: to that of lengths.

    Where there is none to that, it is asked of the rest lengths of forces that leave least over, and what
    follows from the weight of some rest lengths is no proof for others.
    """
    answer = _followed(question, loads, answer)
    if answer.why in (*_UNBORNE, "inexact", "force"):
        answer = _followed(question, loads, _asked(question, loads(least_left_over(question, loads))))
    answer.why = "weight" if answer.why in _UNBORNE else answer.why
    return answer


def _followed(question: Question, loads: LoadsOf, answer: Answer) -> Answer:
    """Return the answer to the weight of its own rest lengths, or to the first weight that has none."""
    last, change = np.inf, 1.0
    while not answer.why and SAME_LENGTH < change < last:
        before, last = np.asarray(answer.rest_lengths), change
        answer = _asked(question, loads(before))
        change = np.inf if answer.why else float(np.abs(answer.rest_lengths / before - 1.0).max())
    return answer


def _asked(question: Question, loads: np.ndarray) -> Answer:
    return prestressed(replace(question, structure=replace(question.structure, loads=loads)))


def least_left_over(question: Question, loads: LoadsOf) -> np.ndarray:
    """Return (b,) rest lengths of the forces, of any signs, that leave least over of the loads of their own.

    A shape with few states bears the weight of its own rest lengths, and that of no others.
    """
    s, mechanics = question.structure, Mechanics(question.structure)
    state = mechanics.at(mechanics.start)
    balance = SelfStress(state, question.classes, question.equal_force, LEAST_TOLERANCE)
    l0, force = s.rest_lengths, mechanics.frame.force
    for _ in range(WEIGHED):
        F = (loads(l0).T.reshape(-1) / force)[s.free.T.reshape(-1)]
        t = balance.forces(balance.nearest(np.zeros(len(balance.size)), F)) * force
        found = question.rest_lengths(s.rest_lengths, t)
        l0 = np.where(np.isnan(found), l0, found)
    return l0
