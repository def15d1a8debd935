"""Two ways round a narrow valley, both by Newton steps with the tangent's own pattern.

**Mixed.** A cable that is slack or hardly strained is hard for any method whose only unknowns are
coordinates: its force is a difference of lengths far below their scatter, and its on and off is a kink. With
an extension e >= 0 and a slackness w >= 0 as unknowns of their own it is a smooth problem,

    loads = rho^T diag(k e / l) rho X        l - l0 = e - w        k e w = nu -> 0

(w = 0 and e of either sign in struts and cables without rest length), solved by Mehrotra's predictor and
corrector (1992). e and w are eliminated: what is left has the tangent's pattern, k e / (e + w) in place of k.

**Softened.** Where an element is stiffer than the forces on the structure by many powers of ten, the energy
is a narrow curved valley: a straight step of angle a stretches it by l a^2 / 2, so that steps shrink with the
root of force over stiffness. With its stiffness capped, like a spring in series, the valley is wide; raising
the cap by stages, each started from the last one's shape, leads to the stiff structure's own equilibrium.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cgff_cli.mechanics import elements
from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.mechanics.tangent import Parts
from cgff_cli.solvers.descent import Detour, iterates
from cgff_cli.solvers.line_search import HUNDREDFOLD, TENFOLD
from cgff_cli.solvers.preconditioners.base import QUARTER, Solve, Tangent
from cgff_cli.solvers.run import Move, Run
from cgff_cli.solvers.saddles import escape
from cgff_cli.solvers.stopping import NEGLIGIBLE
from cgff_cli.structure import Structure

MOST_STEPS = 30
"""Mixed Newton steps: none that arrived took more than 22 (tests/studies/hard_suite.py, large_rulers.py
slack)."""

TO_BOUNDARY = 0.95
"""Share of the way to where an extension or slackness ends; what is left of 1 is how far a step may leave
compatibility, over rest lengths (0.9 and 0.99 did as well: tests/studies/hard_suite.py)."""

STRIDE = 0.5
"""No element vector changes by more than this share of its rest length in a step (1 did as well on
tests/studies/hard_suite.py)."""

LOOSE = 1e-3
"""Least scale of the first extensions over lengths, shortest step, and tolerance of a softer structure (1e-2
and 1e-4 did as well: tests/studies/hard_suite.py)."""


class Mixed:
    """X (d, m), e and w (b,), and Newton steps on them."""

    def __init__(self, state: State):
        self.mechanics = m = state.mechanics
        self.state = state
        self.cable = (m.least == 0.0) & (m.l0 > 0.0)
        self.unit = np.where(m.l0 > 0.0, m.l0, state.size)
        ratio = state.l[self.cable] / m.l0[self.cable]
        own = self.cable if self.cable.any() else np.ones_like(self.cable)
        mu = max(float(ratio.std()), abs(float(ratio.mean()) - 1.0)) if self.cable.any() else 0.0
        force = max(mu, LOOSE) * float(m.kl0[own].mean())
        if m.F is not None:
            force = min(force, float(np.abs(m.F).sum()))
        scale, s = force / m.k, state.stretch
        e = 0.5 * (s + np.hypot(s, 2.0 * scale))
        e = np.clip(e, scale / TENFOLD, scale * TENFOLD)
        free = np.where(m.l0 > 0.0, np.clip(s, -TENFOLD * scale, TENFOLD * scale), s)
        self.e = np.where(self.cable, e, free)
        self.w = np.where(self.cable, np.maximum(e - s, scale * scale / e), 0.0)
        self.shift = 0.0
        self.is_minimum = False

    def step(self, M: Tangent, first: bool) -> Move | None:
        """Take one step; None where its matrix has no factor whatever the shift."""
        m, state, e, w, cable = self.mechanics, self.state, self.e, self.w, self.cable
        rho = state.stretch - e + w
        both = np.where(cable, e + w, 1.0)
        D = np.where(cable, e / both, 1.0)
        solve = self._system(M, D, first)
        if solve is None:
            return None
        nu = m.k * e * w
        mean = float(nu[cable].mean()) if cable.any() else 0.0
        e0 = np.where(cable, (e * rho - e * w) / both, rho)
        dX, dV, de, dw = self._direction(solve, D, rho, e0)
        if mean > 0.0:
            a = min(1.0, self._boundary(de, dw))
            left = float((m.k * (e + a * de) * (w + a * dw))[cable].mean()) / mean
            target = min(max(left**3, LOOSE * LOOSE), TO_BOUNDARY) * mean
            e0 = np.where(cable, (e * rho + target / m.k - e * w - de * dw) / both, rho)
            dX, dV, de, dw = self._direction(solve, D, rho, e0)
        return self._move(dX, dV, de, dw, largest(rho / self.unit))

    def _system(self, M: Tangent, D: np.ndarray, first: bool) -> Solve | None:
        """Return the solver of this step; a shift, and no negative forces, where it would be indefinite."""
        m, state = self.mechanics, self.state
        q = m.k * self.e / state.l
        l2 = state.l * state.l
        clipped = first or self.shift > 0.0
        while self.shift < 1.0:
            own = np.maximum(q, 0.0) if clipped else q
            solve = M.system(Parts(state.X, state.V, (m.k * D - own) / l2, own), self.shift)
            if solve is not None:
                self.is_minimum = self.shift == 0.0 and not (first and bool((self.e < 0.0).any()))
                return solve
            self.shift, clipped = max(self.shift, NEGLIGIBLE) * TENFOLD, True
        return None

    def _direction(
        self, solve: Solve, D: np.ndarray, rho: np.ndarray, e0: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return dX, dV, de, dw: balance with forces k (e + e0) where X stays, compatible to first order."""
        m, state = self.mechanics, self.state
        g = m.connectivity.gather(state.V * (m.k * (self.e + e0) / state.l))
        if m.F is not None:
            g = g - m.F
        if m.mask is not None:
            g = g * m.mask
        dX = -solve(g)
        dV = m.connectivity.differences(dX)
        along = np.einsum("ab,ab->b", state.V, dV) / state.l
        de = e0 + D * along
        return dX, dV, de, np.where(self.cable, de - along - rho, 0.0)

    def _move(self, dX: np.ndarray, dV: np.ndarray, de: np.ndarray, dw: np.ndarray, worst: float) -> Move:
        """Go as far as signs, stride and compatibility allow."""
        m, state = self.mechanics, self.state
        a = min(1.0, TO_BOUNDARY * self._boundary(de, dw))
        stride = float((np.abs(dV).max(axis=0) / self.unit).max())
        a = min(a, STRIDE / stride) if stride > 0.0 else a
        while a > LOOSE:
            l = elements.lengths(state.V + a * dV)
            left = l - m.l0 - (self.e + a * de) + (self.w + a * dw)
            if largest(left / self.unit) <= max(1.0 - TO_BOUNDARY, 2.0 * worst):
                break
            a *= 0.5
        self.state = m.at(state.X + a * dX)
        self.e, self.w = self.e + a * de, self.w + a * dw
        if a > QUARTER:
            self.shift = 0.0
        elif not self.cable.all():
            self.shift = max(TENFOLD * self.shift, NEGLIGIBLE)
        return Move(a * norm(dX), a, 0.0, True)

    def _boundary(self, de: np.ndarray, dw: np.ndarray) -> float:
        """Return the step to where some e or w of a cable becomes 0; infinity if none does."""
        falls = [self.cable & (dv < 0.0) for dv in (de, dw)]
        return min(
            float((v[own] / -dv[own]).min(initial=float("inf")))
            for v, dv, own in ((self.e, de, falls[0]), (self.w, dw, falls[1]))
        )


def mixed(run: Run, M: Tangent) -> Detour:
    """Take mixed Newton steps, and return whether they end at a minimum; if not the run is where it was."""
    before, problem = run.state, Mixed(run.state)
    was_near = _is_near(run)
    for count in range(MOST_STEPS):
        move = problem.step(M, count == 0)
        if move is None or not problem.state.norm < float("inf"):
            break
        run.evaluations += 1
        run.go(problem.state, move)
        is_near = _is_near(run)
        if (is_near and problem.is_minimum) or run.iterations + 1 >= run.watch.max_iterations:
            return True
        yield run.iterate()
        if is_near and was_near:  # balanced, and held there: a saddle
            break
        was_near = is_near
    if run.state is not before:
        run.go(before, Move(norm(run.state.X - before.X), 0.0, 0.0, True))
        yield run.iterate()
    return False


def _is_near(run: Run) -> bool:
    balance = run.watch.gauge.measure(run.state)
    return balance.relative <= run.options.tolerance or balance.at_floor


def softened(run: Run) -> Detour:
    """Go where softer structures lead to, and return whether there are any; iterates show the stiff one.

    A stage that is stuck has led as far as it will: of one, 1164 steps came to nothing.
    """
    first = run.iterations
    for softer in stages(run.mechanics.structure):
        left, before = run.watch.max_iterations - run.iterations, run.evaluations
        options = replace(run.options, preconditioner="tangent", tolerance=LOOSE, max_iterations=left)
        mechanics = Mechanics(softer, run.mechanics.frame)
        stage = Run(mechanics, options, mechanics.at(run.state.X))
        for there in iterates(stage, escape):
            if stage.watch.is_stuck:
                break
            run.evaluations = before + there.evaluations
            if there.number:
                if run.iterations > first:
                    yield run.iterate()
                run.go(run.mechanics.at(there.state.X), there.move)
        run.evaluations = before + stage.evaluations
        run.preconditioner.factorizations += stage.preconditioner.factorizations
    return run.iterations > first


def stages(structure: Structure) -> Iterator[Structure]:
    """Yield the structure with its stiffness capped, softest first; nothing if there is no need of it.

    The first cap is ten times the largest load over the structure's size; without loads, the least
    stiffness. k' = k c / (k + c).
    """
    k = structure.stiffness
    load = largest(structure.loads)
    centred = structure.coordinates - structure.coordinates.mean(axis=0)
    size = largest(centred) + largest(structure.rest_lengths)
    cap = TENFOLD * load / size if load > 0.0 else float(k.min())
    while cap < float(k.max()):
        yield replace(structure, stiffness=k * (cap / (k + cap)))
        cap *= HUNDREDFOLD
