"""The table of the paper's claims in README.md one folder up: table.md with figures of paper_claims.json."""

import json
import re
from collections.abc import Iterable
from math import ceil, log10
from pathlib import Path
from typing import Any

BEGIN, END = "<!-- paper -->\n", "<!-- end -->"
TEMPLATE = Path(__file__).parent / "table.md"
PAGE = Path(__file__).parents[1] / "README.md"
COMMITTED = Path(__file__).parents[1] / "paper_claims.json"
COMMAND = "python tests/studies/paper_claims.py"
NAMES = ("x-module", "hexagon", "prism")
LAWS = ("slack", "push")


def committed() -> dict[str, Any]:
    """Return the measurements that the page shows."""
    return json.loads(COMMITTED.read_text())


def text(data: dict[str, Any]) -> str:
    """Return the table in Markdown."""
    figures = (
        _tables(data["tables"])
        | _iterations(data["iterations"])
        | _speed(data["speed"])
        | _convexity(data["convexity"])
        | _relatives(data["relatives"])
    )
    return TEMPLATE.read_text(encoding="utf-8").format(command=COMMAND, **figures)


def rewrite(path: Path, data: dict[str, Any]) -> None:
    """Put the table between its marks in a page."""
    page = path.read_text(encoding="utf-8")
    made = re.sub(f"(?s)(?<={BEGIN}).*?(?={END})", lambda _: text(data), page, count=1)
    path.write_text(made, encoding="utf-8")


def _each(values: Iterable[object]) -> str:
    """Return the figures of the three structures as `1, 2 and 3`."""
    *first, last = map(str, values)
    return f"{', '.join(first)} and {last}"


def _short(value: float) -> str:
    """Return two digits, as 1.1e-3."""
    digits, power = f"{value:.1e}".split("e")
    return f"{digits}e{int(power)}"


def _ratio(value: float) -> str:
    """Return a ratio of times to one digit, as the second one drifts."""
    return f"{float(f'{value:.1g}'):g}"


def _of(count: int) -> str:
    return str(count) if count else "none"


def _tables(found: dict[str, Any]) -> dict[str, str]:
    two, three, four = (found[name] for name in NAMES)
    return {
        "two_off": f"1e{ceil(log10(two['largest_coordinate_difference']))}",  # rounding: the power will do
        "three_off": _short(three["largest_coordinate_difference"]),
        "three_cgff": _short(three["printed_cgff_residual"]),
        "three_fdm": _short(three["printed_fdm_residual"]),
        "three_miss": _short(three["conic_out_of_reach"]["cgff"]),
        "three_fdm_miss": _short(three["conic_out_of_reach"]["fdm"]),
        "four_off": _short(four["largest_coordinate_difference"]),
        "four_fdm": _short(four["printed_fdm_residual"]),
        "fdm_twist": f"{four['twist']['fdm']:.1f}",
        "our_twist": f"{four['twist']['ours']:.1f}",
        "ranks": _each(found[name]["rank_D"] for name in NAMES),
        "bounds": _each(found[name]["dimension"] + 1 for name in NAMES),
        "nullities": _each(found[name]["nullity_D"] for name in NAMES),
    }


def _iterations(found: dict[str, Any]) -> dict[str, str]:
    many = [found["table1"][name][law] for name in NAMES for law in LAWS]
    own = [found["table1_own_start"][name] for name in NAMES]
    total = {key: sum(one[key] for one in many) for key in ("runs", "stopped", "balanced", "uphill")}
    figures = {
        "runs": str(total["runs"]),
        "settings": str(found["settings"]),
        "stopped": str(total["stopped"]),
        "balanced": _of(total["balanced"]),
        "alike": str(sum(one["like_the_paper"] for one in many)),
        "alike_balanced": _of(sum(one["like_the_paper_balanced"] for one in many)),
        "own_iterations": _each(one["iterations"] for one in own),
        "own_failed": _each(one["failed_trials"] for one in own),
        "own_left": _each(f"{one['left']:.1f}" for one in own),
        "uphill": f"{100 * total['uphill'] / total['stopped']:.0f}",
    }
    for when, place in (("early", 0), ("middle", 3), ("late", -1)):
        rows = [found["table1"][name]["push"]["by_eps"][place] for name in NAMES]
        figures[f"table1_{when}"] = _each(f"{row['median_iterations']:g}" for row in rows)
    for kind in ("energy", "residual"):
        runs = [found["cgff"][name][kind] for name in NAMES]
        figures[f"{kind}_early"] = _each(one["own_start"][0] for one in runs)
        figures[f"{kind}_late"] = _each(one["own_start"][-1] for one in runs)
        figures[f"{kind}_most"] = _each(one["most"][-1] for one in runs)
    return figures


def _speed(found: dict[str, Any]) -> dict[str, str]:
    def ratios(rival: str) -> str:
        return _each(_ratio(found[name][rival]["times_as_long"]) for name in NAMES)

    def reached(rival: str) -> str:
        return _each(found[name][rival]["random_starts_reached"] for name in NAMES)

    hexagon = found["hexagon"]
    table1 = sum(found[name]["table1"]["random_starts_reached"] for name in NAMES)
    return {
        "fsolve_fd": ratios("fsolve fd"),
        "fsolve": ratios("fsolve"),
        "lm_fd": ratios("lm fd"),
        "lm": ratios("lm"),
        "plain": ratios("plain residual"),
        "fsolve_reached": reached("fsolve fd"),
        "lm_reached": reached("lm fd"),
        "cgff_reached": reached("cgff energy"),
        "plain_reached": reached("plain residual"),
        "table1_reached": _of(table1),
        "cgff_evaluations": str(hexagon["cgff energy"]["evaluations"]),
        "cgff_factorizations": str(hexagon["cgff energy"]["tangents"]),
        "fsolve_fd_evaluations": str(hexagon["fsolve fd"]["evaluations"]),
        "loop": _each(_ratio(found[name]["loop_over_numpy"]) for name in NAMES),
    }


def _convexity(found: dict[str, Any]) -> dict[str, str]:
    shares = [found["segments"][name]["push"] for name in NAMES]
    curvature = found["curvature_at_the_start"]["prism"]["push"]
    ends = {law: [found["ends"][name][law]["residual"] for name in NAMES] for law in LAWS}
    energy = [found["ends"][name][law]["energy"] for name in NAMES for law in LAWS]
    return {
        "middle": _short(found["quarter_turn"]["push"]["middle"]),
        "above": _each(round(100 * one["above"] / one["segments"]) for one in shares),
        "least": _short(curvature["least"]),
        "largest": _short(curvature["largest"]),
        "unstable": _each(one["unstable"] for one in ends["push"]),
        "unstable_slack": _each(one["unstable"] for one in ends["slack"]),
        "stationary": str(sum(one["stationary"] for one in ends["push"])),
        "nowhere": str(sum(one["none"] for one in ends["push"])),
        "stable": str(sum(one["stable"] for one in energy)),
        "energy_runs": str(sum(sum(one.values()) for one in energy)),
    }


def _relatives(found: dict[str, Any]) -> dict[str, str]:
    figures = {}
    for objective in ("energy", "residual"):
        counts = [found["rules"][name][objective] for name in NAMES]
        figures[f"fr_{objective}"] = _each(own["FR"] for own in counts)
        others = [[count for rule, count in own.items() if rule != "FR"] for own in counts]
        figures[f"rules_{objective}"] = _each(f"{min(own)} to {max(own)}" for own in others)
    for method in ("znn", "mc"):
        rows = [found[method][name] for name in NAMES]
        figures |= {
            f"{method}_own": _each(row["iterations"] if row["stable"] else "no" for row in rows),
            f"{method}_reached": _each(row["reached"] for row in rows),
            f"{method}_stably": _each(row["stably"] for row in rows),
        }
    return figures
