"""What the commands that compare methods share: flags, the options they stand for, where output goes."""

from collections.abc import Mapping
from typing import Any

import click

from cgff_cli.cli.common import Decorator, flag, flags
from cgff_cli.cli.options import FORMATS, format_flag, given_solve_options, output_flag, solve_option
from cgff_cli.options import OPTIONS

RIVALS = {
    "fdm": ("fdm", "Form-finding from connectivity and signs alone; with supports, --schek."),
    "schek": ("schek", "The linear force density method with CGFF's force densities; needs supports."),
    "fsolve": ("fsolve", "scipy's fsolve with the exact Jacobian."),
    "fsolve-fd": ("fsolve-fd", "scipy's fsolve without a Jacobian, by finite differences."),
    "lm": ("lm", "scipy's Levenberg-Marquardt method with the exact Jacobian."),
    "table1": ("table1", "The paper's Table I to the letter."),
    "residual": ("cgff-residual", "CGFF on eq. (10), half the squared residual."),
    "lbfgs": ("lbfgs", "scipy's L-BFGS-B on the energy."),
    "dr": ("dr", "Dynamic relaxation with kinetic damping."),
    "afdm": ("afdm", "Adaptive force densities: D brought to its rank; without supports."),
    "dsvd": ("dsvd", "Double singular value decomposition of U; without supports."),
    "znn": ("znn", "A zeroing neural network, integrated in time."),
    "mc": ("mc", "Monte Carlo: random nodal moves under falling temperature."),
    "all": ("all", "Every method that suits the scene."),
}
"""Flag -> the method it adds, and its help."""

SOLVE_OPTIONS = tuple(name for name in OPTIONS if name not in ("method", "objective"))
"""The solve options that are flags here; the methods stand for the other two."""


def comparing_flags(default: str, time_limit: float, contents: str, *more: Decorator[Any]) -> Decorator[Any]:
    """Return what adds a flag per rival, then those of comparing, of output, more, and of solving.

    default    : the method flag that holds where none is given
    time_limit : the command's own default
    contents   : what a file gets that -o names
    """
    heading = f"Methods beside CGFF (--{default} unless given)"
    return flags(
        *(flag(f"--{name}", section=heading, is_flag=True, help=text) for name, (_, text) in RIVALS.items()),
        output_flag("-o", "--output", dash=True, help=contents),
        format_flag(
            *FORMATS, help="What to write to standard output. Default: table on a terminal, json in a pipe."
        ),
        *more,
        flag(
            "--repeat",
            section="Comparing",
            type=click.IntRange(min=1),
            metavar="N",
            help="Runs of each method, in turn, unless one fails or runs out of time; times are medians. "
            "Default: 3.",
        ),
        flag(
            "--time-limit",
            section="Comparing",
            type=click.FloatRange(min=0.0, min_open=True),
            metavar="X",
            help=f"Seconds after which a run is ended. Default: {time_limit:g}.",
        ),
        *(solve_option(name, 1e-12 if name == "tolerance" else None) for name in SOLVE_OPTIONS),
    )


def wanted_methods(values: Mapping[str, Any], default: str) -> list[str]:
    """Return the methods whose flags were given, or the default."""
    asked = [method for flag, (method, _) in RIVALS.items() if values[flag.replace("-", "_")]]
    return asked or [default]


def comparing_options(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the options of solving and comparing that were set on the command line."""
    own = {name: values[name] for name in ("repeat", "time_limit") if values[name] is not None}
    return own | given_solve_options(values)
