"""Parameters of a scene family, read from the family's own signature."""

from collections.abc import Callable
from typing import Any, NamedTuple

from cgff_cli.values import Rule

_SMALLEST, _LARGEST = 1e-12, 1e12  # of a length, a force or a count of a family


class Parameter(NamedTuple):
    """One keyword of a family's function; a default of None is explained by its help."""

    name: str
    default: Any
    rule: Rule

    @property
    def kind(self) -> type:
        """The type of its values."""
        return self.rule.kind

    @property
    def flag(self) -> str:
        """The name as a command-line flag."""
        return f"--{self.name.replace('_', '-')}"

    def checked(self, value: object) -> Any:
        """Return a value in the parameter's type; raises OptionError saying what is allowed."""
        return None if value is None and self.default is None else self.rule.checked(self.name, value)


def parameters_of(function: Callable[..., Any]) -> dict[str, Parameter]:
    """Return the keyword-only parameters of a function annotated with rules, in order."""
    found = {}
    for name, default in (function.__kwdefaults__ or {}).items():
        hint = function.__annotations__[name]
        kind = next((kind for kind in (int, str) if hint.__origin__ in (kind, kind | None)), float)
        rule = hint.__metadata__[0]
        smallest = _SMALLEST if rule.positive else 0.0
        rule = rule._replace(kind=kind, smallest=smallest, largest=_LARGEST)
        found[name] = Parameter(name, default, rule)
    return found
