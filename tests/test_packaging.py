"""What the package asks for: bounds on every requirement, and exact versions for the tests."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PINNED = (ROOT / "tests" / "constraints.txt").read_text(encoding="utf-8").splitlines()


def test_what_users_install_has_lower_and_upper_bounds():
    extras = PROJECT["project"]["optional-dependencies"]
    asked = PROJECT["project"]["dependencies"] + PROJECT["build-system"]["requires"]
    for requirement in asked + extras["cholmod"] + extras["plot"]:
        assert re.fullmatch(r"[a-z0-9]+>=[0-9.]+,<[0-9]+", requirement), requirement


def test_the_tests_install_every_extra_in_exact_versions():
    asked = PROJECT["project"]["optional-dependencies"]["test"]
    assert "cgff-cli[cholmod,plot]" in asked
    pinned = {line.split("==")[0].lower().replace("_", "-") for line in PINNED if line[0] != "#"}
    assert all("==" in line for line in PINNED if line[0] != "#")
    wanted = {re.match(r"[\w-]+", name)[0].lower() for name in asked + PROJECT["project"]["dependencies"]}
    assert wanted - {"cgff-cli"} <= pinned


def test_nothing_names_a_place_to_install_from():
    for line in PINNED:
        assert "://" not in line
        assert not line.startswith("-")
