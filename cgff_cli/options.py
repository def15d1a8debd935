"""Every solve option, its default and what it may be: the one place all three doors share.

The scene's `solver:` block, the command line's flags and Python's keywords are all read from
`SolveOptions`; a flag is the field's name with dashes.
"""

from collections.abc import Mapping
from dataclasses import Field, dataclass, field, fields
from typing import Any

from cgff_cli.errors import OptionError
from cgff_cli.hints import meant_or_all
from cgff_cli.values import Rule


def _option(default: object, rule: Rule) -> Any:
    spread = {**rule._asdict(), "rule": rule, "type": rule.kind, "allowed": rule.choices}
    return field(default=default, metadata=spread)


def _choice(default: str, allowed: tuple[str, ...], text: str) -> Any:
    return _option(default, Rule(text, str, choices=allowed))


def _number(default: float, below: float, text: str) -> Any:
    return _option(default, Rule(text, positive=True, below=below))


def _whole(default: int, text: str) -> Any:
    return _option(default, Rule(text, int, least=0, largest=2**53))


@dataclass(frozen=True)
class SolveOptions:
    """All options of a solve, with their defaults."""

    method: str = _choice("cgff", ("cgff", "table1"), "cgff, or the paper's Table I to the letter")
    objective: str = _choice(
        "energy",
        ("energy", "residual"),
        "what cgff minimises: energy, or eq. (10), half the squared residual",
    )
    cg_beta: str = _choice(
        "FR", ("FR", "PR+", "HS", "DY", "TT", "SP", "HZ"), "conjugate gradient coefficient"
    )
    preconditioner: str = _choice(
        "auto",
        ("auto", "tangent", "frames", "none"),
        "shifted tangent stiffness; local frames, for anchored cable nets; or plain conjugate gradients",
    )
    factor: str = _choice(
        "auto",
        ("auto", "superlu", "cholmod"),
        "sparse factors of large scenes; auto: cholmod where it is installed",
    )
    tolerance: float = _number(
        1e-10, 1.0, "largest out-of-balance force component over the largest force at which to stop"
    )
    max_iterations: int = _whole(2000, "iterations after which to give up")
    seed: int = _whole(0, "seed of the tiny perturbation that frees coincident or symmetric starts")
    analysis: str = _choice(
        "auto",
        ("auto", "always", "never"),
        "ranks and stability of the result; auto: in large scenes stability alone",
    )
    alpha: float = _number(1.0, float("inf"), "table1: first step length")
    step_factor: float = _number(0.5, 1.0, "table1: b, the factor that shrinks (and 1/b grows) alpha")
    eps: float = _number(1e-8, float("inf"), "table1: stop when the norm of alpha d is at most this")

    def merged(self, changes: Mapping[str, object]) -> "SolveOptions":
        """Return these options with some changed; raises OptionError for a bad name or value."""
        return SolveOptions(**vars(self) | {name: checked(name, value) for name, value in changes.items()})

    def to_dict(self) -> dict[str, Any]:
        """Return the options by name, in declaration order."""
        return dict(vars(self))


DEFAULTS = SolveOptions()
OPTIONS: dict[str, Field[Any]] = {option.name: option for option in fields(SolveOptions)}


def checked(name: str, value: object) -> Any:
    """Return one option's value in its own type, or raise OptionError saying what is allowed."""
    if name not in OPTIONS:
        raise OptionError(f"unknown solve option {name!r}{meant_or_all(name, OPTIONS)}")
    return OPTIONS[name].metadata["rule"].checked(name, value)
