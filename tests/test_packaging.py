"""What the package asks for: bounds on every requirement, and exact versions for the tests and the build."""

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
EXTRAS = PROJECT["project"]["optional-dependencies"]
ASKED = PROJECT["project"]["dependencies"] + PROJECT["build-system"]["requires"]
PINNED = (ROOT / "tests" / "constraints.txt").read_text(encoding="utf-8").splitlines()


def test_what_users_install_has_lower_and_upper_bounds():
    extras = [one for name, own in EXTRAS.items() if name != "test" for one in own]
    for requirement in ASKED + extras:
        assert re.fullmatch(r"[a-z0-9-]+>=[0-9.]+,<[0-9]+", requirement), requirement


def test_the_tests_install_every_extra_in_exact_versions():
    asked = sum(EXTRAS.values(), ASKED)
    asked.remove("cgff-cli[cholmod,dask,plot,view,mesh,dxf]")
    exact = [re.fullmatch(r"([\w-]+)==[\w.]+", line) for line in PINNED if not line.startswith("#")]
    assert all(exact)
    wanted = {re.match(r"[\w-]+", name)[0].lower() for name in asked}
    assert wanted <= {line[1].lower() for line in exact}
