"""What a value may be: its type, its range or its choices, and the sentence that says so.

Solve options, parameters of families and numbers of scenes are all held against a `Rule`.
"""

from math import inf
from typing import Any, NamedTuple

from cgff_cli.errors import OptionError

LONGEST = 256
"""Most characters of a text or name; a YAML key may not be much longer."""


DEAD, ALL_CASES = "dead", "all"
"""What combinations call weight and loads, and `--case` every case and combination."""


class Rule(NamedTuple):
    """What a value means and may be; stands in `Annotated[type, Rule(...)]` and behind options.

    least, most       : ends of the range, allowed themselves
    positive, below   : ends that are not
    smallest, largest : sizes of a number other than 0; too far out for a sentence to speak of
    """

    help: str = ""
    kind: type = float
    least: float | None = None
    most: float = inf
    positive: bool = False
    below: float = inf
    choices: tuple[str, ...] = ()
    smallest: float = 0.0
    largest: float = inf

    def checked(self, name: str, value: object) -> Any:
        """Return a value in its own type; raises OptionError saying what is allowed."""
        found = str(value) if self.kind is str else as_number(value)
        if found is None or not (self._is_text(found) if isinstance(found, str) else self.fits(found)):
            raise OptionError(f"{name} must be {self.allowed}, got {value!r}")
        return self.kind(found)

    def fits(self, number: Any) -> Any:
        """Return whether a number is inside its range; of an array, whether each one is."""
        size = abs(number)
        inside = (size <= self.largest) & (number < self.below) & (number <= self.most)
        if self.positive:
            inside &= number > 0.0
        if self.least is not None:
            inside &= number >= self.least
        if self.smallest:
            inside &= (size >= self.smallest) | (number == 0.0)
        return inside & (number % 1 == 0) if self.kind is int else inside

    def _is_text(self, text: str) -> bool:
        return text in self.choices if self.choices else 0 < len(text) <= LONGEST and text.isprintable()

    @property
    def allowed(self) -> str:
        """What the value may be, in words."""
        if self.kind is str:
            return f"one of {', '.join(self.choices)}" if self.choices else "a text of one line"
        return f"a {'whole ' if self.kind is int else ''}number {self.range}"

    @property
    def range(self) -> str:
        """Where a number may lie, in words."""
        if self.positive and self.below < inf:
            return f"between 0 and {self.below:g}"
        if self.positive:
            return "> 0" if self.most == inf else f"> 0 and <= {self.most:.17g}"
        if self.least is None:
            return f"of at most {short(self.largest)} in size"
        return f">= {self.least:.17g}" if self.most == inf else f"from {self.least:.17g} to {self.most:.17g}"

    def fault(self, number: float, got: str) -> str | None:
        """Return which end of its range a number of a scene is beyond, or None where it is inside."""
        if self.fits(number):
            return None
        if number <= 0.0 if self.positive else self.least is not None and number < self.least:
            return f"must be {self.range}, got {got}"
        if abs(number) > self.largest:
            return f"must not exceed {short(self.largest)} in size, got {got}"
        return f"must be at least {short(self.smallest)}, got {got}"


def short(number: float) -> str:
    """Return a power of ten as people write it: 1e30."""
    return f"{number:g}".replace("e+", "e")


def as_number(value: object) -> int | float | None:
    """Return a number of Python or numpy, infinite where no double is as large; None of anything else."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        float(value)
    except OverflowError:
        return inf if value > 0 else -inf
    return value
