"""How a run can end."""

from enum import Enum


class Verdict(str, Enum):
    """What a run reached; only the first two are an equilibrium."""

    CONVERGED = "converged"
    ROUNDING_FLOOR = "rounding_floor"
    STATIONARY = "stationary_not_equilibrium"
    STEP_VANISHED = "step_vanished"
    MAX_ITERATIONS = "max_iterations"
    DIVERGED = "diverged"
    INTERRUPTED = "interrupted"

    @property
    def converged(self) -> bool:
        """True where the forces balance."""
        return self in (Verdict.CONVERGED, Verdict.ROUNDING_FLOOR)

    def __str__(self) -> str:
        return self.value
