"""What can go wrong, sorted by who can mend it."""

from collections.abc import Sequence
from typing import NamedTuple


class CgffError(Exception):
    """Anything cgff raises on purpose; its text is a sentence for a person."""


class OptionError(CgffError):
    """A solve option that does not exist or has a value it cannot take."""


class Problem(NamedTuple):
    """One mistake in a file; line and column count from 1; problems sort by place.

    Both are 0 where a problem has no place, as that of a file that cannot be read.
    """

    path: str
    line: int
    column: int
    message: str

    def __str__(self) -> str:
        place = f":{self.line}:{self.column}" if self.line else ""
        return f"{self.path}{place}: {self.message}"


class SceneError(CgffError):
    """A scene file that cannot be used, with every problem found in it."""

    def __init__(self, problems: Sequence[Problem]):
        self.problems = tuple(sorted(problems))
        super().__init__("\n".join(str(problem) for problem in self.problems))

    def __reduce__(self) -> tuple[type, tuple[Sequence[Problem]]]:
        """Return what makes it anew where it comes out of another process."""
        return type(self), (self.problems,)
