"""The page beside the solvers: its numbers are those of the program."""

from cgff_cli.solvers.descent import LOST
from cgff_cli.solvers.line_search import HUNDREDFOLD, MOST_TRIALS, TENFOLD
from cgff_cli.solvers.preconditioners.base import FIRST_SHIFT, LONG_STEP, QUARTER
from cgff_cli.solvers.stopping import PATIENCE, WAIT
from tests.pages import section

WORDS = {3: "three", 10: "tenfold", 100: "a hundred times"}


def test_the_numbers_of_the_loop_are_those_of_the_program():
    said = " ".join((section("Where it departs from the paper") + section("Preconditioners")).split())
    for number in (
        f"above {LOST:g} of <grad_k, z_k>",
        f"up to {MOST_TRIALS} times",
        f"After {WAIT} iterations that did not halve the residual, at most {WORDS[PATIENCE]} times",
        f"a cap {WORDS[HUNDREDFOLD]} higher",
        f"starts at {FIRST_SHIFT:.0e}".replace("e-0", "e-"),
        f"falls at least {WORDS[TENFOLD]} after a step above {LONG_STEP:g}",
        f"rises {WORDS[TENFOLD]} after one below {QUARTER:g}",
    ):
        assert number in said
