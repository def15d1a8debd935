"""What a parameter of a scene family may be, read from the family's own signature."""

from collections.abc import Callable
from typing import Any, NamedTuple

from cgff_cli.errors import OptionError

_LARGEST = 1e12
_SMALLEST = 1e-12


class Rule(NamedTuple):
    """What a parameter means and the range or choice it has; stands in `Annotated[type, Rule(...)]`."""

    help: str
    least: float = -_LARGEST
    most: float = _LARGEST
    positive: bool = False
    choices: tuple[str, ...] = ()


class Parameter(NamedTuple):
    """One keyword of a family's function; a default of None is explained by its help."""

    name: str
    kind: type
    default: Any
    rule: Rule

    @property
    def flag(self) -> str:
        """The name as a command-line flag."""
        return f"--{self.name.replace('_', '-')}"

    def checked(self, value: object) -> Any:
        """Return a value in the parameter's type; raises OptionError saying what is allowed."""
        if value is None and self.default is None:
            return None
        if self.kind is str:
            return self._checked_text(value)
        number = _as_number(value)
        if number is None or not self._fits(number):
            raise OptionError(f"{self.name} must be {self.allowed}, got {value!r}")
        return self.kind(number)

    @property
    def allowed(self) -> str:
        """What the parameter may be, in words."""
        rule = self.rule
        if self.kind is str:
            return f"one of {', '.join(rule.choices)}" if rule.choices else "a text of one line"
        noun = "a whole number" if self.kind is int else "a number"
        if rule.positive:
            return f"{noun} > 0" if rule.most == _LARGEST else f"{noun} > 0 and <= {rule.most:.17g}"
        if rule.least == -_LARGEST:
            return f"{noun} of at most 1e12 in size"
        return (
            f"{noun} >= {rule.least:.17g}"
            if rule.most == _LARGEST
            else f"{noun} from {rule.least:.17g} to {rule.most:.17g}"
        )

    def _fits(self, number: float) -> bool:
        least = _SMALLEST if self.rule.positive else self.rule.least
        return least <= number <= self.rule.most and (self.kind is not int or number == int(number))

    def _checked_text(self, value: object) -> str:
        choices = self.rule.choices
        text = str(value)
        if (choices and text not in choices) or not 0 < len(text) <= 256 or not text.isprintable():
            raise OptionError(f"{self.name} must be {self.allowed}, got {value!r}")
        return text


def parameters_of(function: Callable[..., Any]) -> dict[str, Parameter]:
    """Return the keyword-only parameters of a function annotated with rules, in order."""
    found = {}
    for name, default in (function.__kwdefaults__ or {}).items():
        hint = function.__annotations__[name]
        kind = next((kind for kind in (int, str) if hint.__origin__ in (kind, kind | None)), float)
        found[name] = Parameter(name, kind, default, hint.__metadata__[0])
    return found


def _as_number(value: object) -> int | float | None:
    if isinstance(value, bool):
        return None
    if hasattr(value, "tolist"):  # numpy's scalars
        value = value.tolist()
    return value if isinstance(value, (int, float)) else None
