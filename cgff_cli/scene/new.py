"""The door to the families: a name and parameters in, a scene and words about it out."""

from collections.abc import Callable, Mapping
from importlib import import_module
from shlex import quote
from typing import Any, NamedTuple

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.hints import meant_or_all
from cgff_cli.scene.equilibrium import Equilibrium, realised
from cgff_cli.scene.families import FAMILIES
from cgff_cli.scene.scene import Scene
from cgff_cli.values import Rule

_SMALLEST, _LARGEST = 1e-12, 1e12  # of a length, a force or a count of a family


class Parameter(NamedTuple):
    """One keyword of a family's function; a default of None is explained by its help."""

    name: str
    default: Any
    rule: Rule

    @property
    def flag(self) -> str:
        """The name as a command-line flag."""
        return f"--{self.name.replace('_', '-')}"

    def checked(self, value: object) -> Any:
        """Return a value in the parameter's type; raises OptionError saying what is allowed."""
        return None if value is None and self.default is None else self.rule.checked(self.name, value)


class Family(NamedTuple):
    """A family: its function, its own parameters and those that all families share."""

    name: str
    equilibrium: Callable[..., Equilibrium]
    own: dict[str, Parameter]
    common: dict[str, Parameter]
    examples: tuple[str, ...]


def new(family: str, **parameters: object) -> Scene:
    """Return a scene of a family, such as `new("prism", sides=5, noise=0.1, seed=1)`.

    Parameters are those of the family and of `realised`; raises OptionError for a bad name or value.
    """
    return make(family, parameters)[0]


def find(name: str) -> Family:
    """Return a family by name; raises OptionError with the nearest name where there is none."""
    if name not in FAMILIES:
        raise OptionError(f"unknown family {name!r}{meant_or_all(name, FAMILIES)}")
    module = import_module(f"cgff_cli.scene.families.{name.replace('-', '_')}")
    own = _parameters_of(module.equilibrium)
    return Family(name, module.equilibrium, own, _parameters_of(realised), module.EXAMPLES)


def make(name: str, given: Mapping[str, object]) -> tuple[Scene, str]:
    """Return the scene of a family with some parameters given, and its header."""
    family = find(name)
    known = family.own | family.common
    for key in given:
        if key not in known:
            raise OptionError(f"unknown parameter {key!r} of {name}{meant_or_all(key, known)}")
    values = {key: known[key].checked(value) for key, value in given.items()}
    target = family.equilibrium(**{key: value for key, value in values.items() if key in family.own})
    common = {key: value for key, value in values.items() if key in family.common}
    scene = realised(target, **common)
    flags = [(known[key], values[key]) for key in known if key in values]
    exact = not target.added_loads and not target.weight and not values.get("jitter")
    return scene, _header(name, target, flags, exact)


def _parameters_of(function: Callable[..., Any]) -> dict[str, Parameter]:
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


def _header(name: str, target: Equilibrium, flags: list[tuple[Parameter, Any]], exact: bool) -> str:
    said = "".join(f" {p.flag} {quote(str(value))}" for p, value in flags if value != p.default)
    lines = [f"{target.title}.", f"Made by: cgff new {name}{said}", ""]
    lines += [target.added] if target.added else []
    if not exact:
        return "\n".join([*lines, "Rest lengths or loads are off the closed form: no answer is on paper."])
    lines += [f"Answer: {target.answer}", *_answer_table(target)]
    return "\n".join(lines)


def _answer_table(target: Equilibrium) -> list[str]:
    """Return lengths and forces of each group in equilibrium, `least .. largest` where they differ."""
    rows = [("group", "length", "force")]
    for own in target.members:
        rows.append((own.name, _span(target.lengths(own)), _span(target.forces(own))))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  " + "  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]


def _span(values: np.ndarray) -> str:
    low, high = (f"{value:.10g}" for value in (values.min(), values.max()))
    return low if low == high else f"{low} .. {high}"
