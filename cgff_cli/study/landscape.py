"""What a search for equilibria found: counts, distinct shapes by energy; its record, cgff-equilibria/1."""

from dataclasses import dataclass, field
from typing import Any

from cgff_cli import TOOL
from cgff_cli.scene.scene import Scene
from cgff_cli.study.levels import levels
from cgff_cli.study.shapes import Shape, Shapes

EQUILIBRIA_SCHEMA = "cgff-equilibria/1"

COLUMNS_OF_EQUILIBRIA = (
    "energy",
    "kind",
    "count",
    "stability",
    "smallest_stiffness",
    "slack_count",
    "residual_relative",
    "first_start",
)


@dataclass(eq=False)
class Landscape:
    """What came of some starts: distinct shapes, how many answers are none, or are neutral and left out."""

    shapes: Shapes = field(default_factory=Shapes)
    solved: int = 0
    not_converged: int = 0
    left_neutral: int = 0

    def add(self, others: "Landscape") -> None:
        """Take in what came of other starts, later ones."""
        for shape in others.shapes:
            self.shapes.add(shape)
        self.solved += others.solved
        self.not_converged += others.not_converged
        self.left_neutral += others.left_neutral


@dataclass(frozen=True, eq=False)
class Equilibria:
    """What a search found. kinds_of: the kind of each shape, from 1; is_interrupted: Ctrl-C ended it."""

    source: Scene
    seed: int
    landscape: Landscape
    shapes: tuple[Shape, ...]
    kinds_of: tuple[int, ...]
    is_interrupted: bool = False

    @property
    def starts(self) -> int:
        """Starts solved."""
        return self.landscape.solved

    @property
    def kinds(self) -> int:
        """Number of kinds among the equilibria listed."""
        return len(set(self.kinds_of))

    @property
    def least(self) -> list[int]:
        """Places of the stable equilibria of the least energy: of all that rounding does not tell from it."""
        stable = [place for place, own in enumerate(self.shapes) if own.stability == "stable"]
        level = levels([self.shapes[place] for place in stable])
        return [place for place, own in zip(stable, level, strict=True) if own == 0]

    def led_to(self, stability: str | None) -> int:
        """Return how many starts led to equilibria of that stability; None: which it is cannot be told."""
        found = sum(own.count for own in self.landscape.shapes if own.stability == stability)
        return found + (self.landscape.left_neutral if stability == "neutral" else 0)

    @property
    def equilibria(self) -> list[dict[str, Any]]:
        """The equilibria listed, as plain values, by energy."""
        names = self.source.node_names
        return [
            {
                "energy": own.energy,
                "kind": kind,
                "count": own.count,
                "stability": own.stability,
                "smallest_stiffness": own.smallest_stiffness,
                "slack_count": own.slack_count,
                "residual_relative": own.residual_relative,
                "nodes": dict(zip(names, own.coordinates.tolist(), strict=True)),
                "first_start": own.first_start,
            }
            for own, kind in zip(self.shapes, self.kinds_of, strict=True)
        ]

    def columns(self) -> dict[str, list[Any]]:
        """Return the equilibria listed as a table, without their nodes."""
        rows = self.equilibria
        return {name: [row[name] for row in rows] for name in COLUMNS_OF_EQUILIBRIA}

    def to_dict(self) -> dict[str, Any]:
        """Return every field of the JSON, in the order it is written."""
        return {
            "schema": EQUILIBRIA_SCHEMA,
            "tool": dict(TOOL),
            "scene": self.source.summary,
            "starts": self.starts,
            "seed": self.seed,
            "interrupted": self.is_interrupted,
            "not_converged": self.landscape.not_converged,
            "unstable": self.led_to("unstable"),
            "neutral": self.led_to("neutral"),
            "undecided": self.led_to(None),
            "kinds": self.kinds,
            "equilibria": self.equilibria,
        }
