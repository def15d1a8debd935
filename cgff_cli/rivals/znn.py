"""A zeroing neural network that suppresses noise: the forces are made to die out in a time of their own.

    d eta / dt = -gamma eta - lambda integral of eta      and so, with d eta / dX = -K,
    K dX/dt = gamma eta + lambda s,    ds/dt = eta        (the kind of the paper's [22])

The integral takes out a constant noise w on the right, which alone would leave eta = -w / gamma. scipy's
Runge and Kutta method of order 5 takes the time steps. K has no inverse where a body is free: its
pseudo-inverse stands for it. The network goes to any equilibrium, stable or not, and gets stuck where K
loses rank on the way: of soft structures it finds what begins within a thousandth of their lengths.

A constant noise with a torque turns a free body, which nothing holds, the faster the less is left of the
forces: there the integral leaves some of it.

Public are abstracts (Sun, Zhao and others, Neural Comput. Appl. 34, 2022, put a modified BFGS matrix, which
is positive, for K), and the law for eta, in programs for linear systems. gamma sets the unit of time, so 1;
lambda = gamma^2 / 4, the most that does not swing, and the rank tolerance, accuracy and length of the steps
are ours.
"""

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.rivals.scipy_solvers import System
from cgff_cli.rivals.task import End, Task, Trace

GAMMA, LAMBDA = 1.0, 0.25

RANK = 1e-9
"""Eigenvalues of K below this share of the largest count as none."""

ACCURACY = 1e-3
"""Error of a time step over the unknowns, the integral too."""

LONGEST_STEP = 2.0
"""Longest time step, in units of 1 / gamma: above 3.3 the method would not let decay what decays at gamma."""

MOST_UNKNOWNS = 500
"""Above, the pseudo-inverses, seven each time step, are not made."""

STEPS = 2000
"""Time steps after which it gives up: where K loses rank on the way, steps shrink and lead nowhere."""


def znn(task: Task, trace: Trace, gain: float = LAMBDA, noise: float = 0.0) -> End:
    """Follow the network from the scene's start; raises CgffError where the scene is too large.

    gain: lambda; noise: constant on each free coordinate of the right side. An iteration is a time step.
    """
    from scipy.integrate import RK45

    system = System(task, trace, counts_jacobians=True)
    count = len(system.start)
    if count > MOST_UNKNOWNS:
        raise CgffError(f"its pseudo-inverses are made for up to {MOST_UNKNOWNS} unknowns, here are {count}")

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        x, total = y[:count], y[count:]
        eta = -system.gradient(system.state(x))
        right = GAMMA * eta + gain * total + noise
        return np.concatenate([np.linalg.pinv(system.jacobian(x), RANK, hermitian=True) @ right, eta])

    begun = np.concatenate([system.start, np.zeros(count)])
    path = RK45(rates, 0.0, begun, np.inf, max_step=LONGEST_STEP, rtol=ACCURACY, atol=np.finfo(float).eps)
    for step in range(STEPS):
        system.add(step, path.nfev, system.state(path.y[:count]))
        message = path.step()
        if path.status == "failed":
            break
    return system.ended(path.y[:count], message or f"not there after {STEPS} time steps")
