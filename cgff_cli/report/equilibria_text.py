"""The equilibria of a scene for the terminal: what was found in words, then a table."""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from cgff_cli.hints import count
from cgff_cli.report.table import FEW
from cgff_cli.report.terminal import Aligned, Column, column, fields, heading, number, numbers
from cgff_cli.study.landscape import Equilibria

Entries = Sequence[dict[str, Any]]


def verdict_of(found: Equilibria) -> str:
    """Return in one sentence how many stable equilibria there are, and how often the best came up."""
    stable = [own for own in found.equilibria if own["stability"] == "stable"]
    starts = count(found.starts, "start")
    if not stable:
        return f"no stable equilibrium in {starts}"
    many = count(len(stable), "stable equilibrium", "stable equilibria")
    kinds = count(len({own["kind"] for own in stable}), "kind")
    return f"{many} of {kinds} in {starts}; {_least(found)}"


def _least(found: Equilibria) -> str:
    """Return which energy is the least, how many shapes have it, and how many starts led to them."""
    best = [found.shapes[place] for place in found.least]
    energy, starts = number(best[0].energy_told), sum(own.count for own in best)
    if len(best) == 1:
        return f"the one of least energy, {energy}, from {starts}"
    kinds = count(len({found.kinds_of[place] for place in found.least}), "kind")
    return f"{len(best)} shapes of {kinds} share the least energy, {energy}, from {starts}"


def equilibria_page(found: Equilibria, full: bool = False) -> Iterator[RenderableType]:
    """Yield the page; full: list every equilibrium, however many; else many are summed up by kind."""
    yield Text.assemble(
        heading(found.source), "  ", ("interrupted" if found.is_interrupted else "", "yellow")
    )
    yield fields(_facts(found))
    told = (own.energy_told for own in found.shapes)
    entries = [own | {"energy": energy} for own, energy in zip(found.equilibria, told, strict=True)]
    if entries:
        yield Aligned(list(_rows(entries) if full or len(entries) <= FEW else _kinds(entries)))


def _facts(found: Equilibria) -> Iterator[tuple[str, str]]:
    yield "verdict", verdict_of(found)
    others = [
        f"{number} {words}"
        for number, words in (
            (found.led_to("unstable"), "at an unstable equilibrium"),
            (found.led_to("neutral"), "at a neutral one"),
            (found.led_to(None), "at one whose stability rounding hides"),
            (found.landscape.not_converged, "at none"),
        )
        if number
    ]
    if others:
        yield "other starts", f"ended {', '.join(others)}"
    entries = found.equilibria
    if entries:
        last = max(own["first_start"] for own in entries)
        once = sum(own["count"] == 1 for own in entries)
        words = f"; {once} came up only once, so that more starts may well find more" if once else ""
        yield "last new one", f"found by start {last}, the first being start 0, the scene's own{words}"


def _rows(entries: Entries) -> Iterator[Column]:
    yield column("kind", _of(entries, "kind"))
    yield Column("energy", numbers(_of(entries, "energy")), True)
    yield column("starts", _of(entries, "count"))
    yield column("first", _of(entries, "first_start"))
    yield column("stability", _of(entries, "stability"), to_the_right=False)
    yield column("softest", _of(entries, "smallest_stiffness"), "{:#.3g}".format)
    yield column("slack", _of(entries, "slack_count"))


def _kinds(entries: Entries) -> Iterator[Column]:
    """Yield columns with a row for each of the best kinds."""
    shapes = Counter(own["kind"] for own in entries)
    starts: Counter[int] = Counter()
    for own in entries:
        starts[own["kind"]] += own["count"]
    firsts = list({own["kind"]: own for own in reversed(entries)}.values())[::-1][:FEW]
    yield column("kind", _of(firsts, "kind"))
    yield Column("energy", numbers(_of(firsts, "energy")), True)
    yield column("shapes", (shapes[own["kind"]] for own in firsts))
    yield column("starts", (starts[own["kind"]] for own in firsts))
    yield column("stability", _of(firsts, "stability"), to_the_right=False)
    yield column("softest", _of(firsts, "smallest_stiffness"), "{:#.3g}".format)
    yield column("slack", _of(firsts, "slack_count"))


def _of(entries: Entries, name: str) -> list[Any]:
    return [own[name] for own in entries]
