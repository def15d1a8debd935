"""Solve options: defaults, what each may be, and what a refusal says."""

import re

import pytest

import cgff_cli
from cgff_cli.options import OPTIONS, SolveOptions, checked

DEFAULTS = {
    "method": "cgff",
    "objective": "energy",
    "cg_beta": "FR",
    "preconditioner": "auto",
    "tolerance": 1e-10,
    "max_iterations": 2000,
    "seed": 0,
    "analysis": "auto",
    "alpha": 1.0,
    "step_factor": 0.5,
    "eps": 1e-8,
}
CHOICES = {name for name, value in DEFAULTS.items() if isinstance(value, str)}
WHOLE = {"max_iterations", "seed"}
NUMBERS = set(DEFAULTS) - CHOICES - WHOLE


@pytest.mark.parametrize("name", list(DEFAULTS))
def test_every_option_named_here_exists_has_this_default_and_accepts_it(name):
    assert SolveOptions().to_dict()[name] == DEFAULTS[name]
    assert checked(name, DEFAULTS[name]) == DEFAULTS[name]
    assert OPTIONS[name].metadata["help"]


def test_changes_are_merged_into_a_copy():
    usual = SolveOptions()
    changed = usual.merged({"tolerance": 1e-6, "method": "table1"})
    assert (changed.tolerance, changed.method, changed.cg_beta) == (1e-6, "table1", "FR")
    assert usual == SolveOptions()
    assert usual.merged({}) == usual


def test_options_are_frozen():
    with pytest.raises(AttributeError):
        SolveOptions().tolerance = 1.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        (name, x)
        for name in sorted(NUMBERS)
        for x in (1, 2**-20, 1e-300)
        if x < OPTIONS[name].metadata["below"]
    ],
)
def test_numbers_become_floats(name, value):
    found = checked(name, value)
    assert (type(found), found) == (float, float(value))


@pytest.mark.parametrize("name", sorted(WHOLE))
@pytest.mark.parametrize("value", [0, 7, 7.0, 2**53])
def test_whole_numbers_become_ints(name, value):
    assert (type(checked(name, value)), checked(name, value)) == (int, int(value))


@pytest.mark.parametrize("name", sorted(NUMBERS))
@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf"), "1e-8", None, True, [1e-8]])
def test_a_number_out_of_range_is_refused(name, value):
    limit = "between 0 and 1" if OPTIONS[name].metadata["below"] == 1.0 else "> 0"
    with pytest.raises(
        cgff_cli.OptionError, match=re.escape(f"{name} must be a number {limit}, got {value!r}")
    ):
        checked(name, value)


@pytest.mark.parametrize("name", ["tolerance", "step_factor"])
def test_a_share_of_one_is_refused(name):
    with pytest.raises(cgff_cli.OptionError, match=f"{name} must be a number between 0 and 1, got 1"):
        checked(name, 1.0)


@pytest.mark.parametrize("name", sorted(WHOLE))
@pytest.mark.parametrize("value", [-1, 1.5, float("nan"), float("inf"), 2.0**54, "3", None, False, [1]])
def test_anything_but_a_whole_number_is_refused(name, value):
    message = re.escape(f"{name} must be a whole number >= 0, got {value!r}")
    with pytest.raises(cgff_cli.OptionError, match=message):
        checked(name, value)


@pytest.mark.parametrize("name", sorted(CHOICES))
@pytest.mark.parametrize("value", ["", "Energy", 3, None, True, ["cgff"], {}])
def test_a_choice_that_is_none_is_refused_with_all_there_are(name, value):
    allowed = ", ".join(OPTIONS[name].metadata["allowed"])
    message = re.escape(f"{name} must be one of {allowed}, got {value!r}")
    with pytest.raises(cgff_cli.OptionError, match=message):
        checked(name, value)


def test_a_misspelt_option_is_refused_with_its_nearest_name():
    message = re.escape("unknown solve option 'tolerence'; did you mean 'tolerance'?")
    with pytest.raises(cgff_cli.OptionError, match=message):
        SolveOptions().merged({"tolerence": 1e-8})


def test_an_unknown_option_is_refused_with_all_there_are():
    with pytest.raises(cgff_cli.OptionError, match=re.escape(f"allowed: {', '.join(OPTIONS)}")):
        SolveOptions().merged({"zzz": 1})


def test_an_option_error_is_an_error_of_cgff():
    assert issubclass(cgff_cli.OptionError, cgff_cli.CgffError)
