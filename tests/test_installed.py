"""A plain install, away from the clone: the paper's structures come with the package."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import cgff_cli
from cgff_cli.scene.read import PAPER

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install the package into a folder of its own, without what it depends on, and return the folder."""
    folder = tmp_path_factory.mktemp("installed")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(folder), str(ROOT)]
    made = subprocess.run(pip, capture_output=True, text=True)
    if made.returncode and "hatchling" in made.stderr:
        pytest.skip("no package index here to build with hatchling")
    assert made.returncode == 0, made.stderr
    return folder


def test_compare_runs_the_papers_structures_from_any_folder(installed: Path, tmp_path: Path):
    command = [sys.executable, "-m", "cgff_cli", "compare", "--fdm", "--repeat", "1"]
    environment = {**os.environ, "PYTHONPATH": str(installed)}
    ended = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    paths = [Path(json.loads(line)["scene"]["path"]) for line in ended.stdout.splitlines()]
    assert paths == [installed / "cgff_cli" / "structures" / f"{name}.yaml" for name in PAPER]


def test_all_structures_of_the_clone_are_in_the_package(installed: Path):
    here, there = ROOT / "structures", installed / "cgff_cli" / "structures"
    names = {path.relative_to(here) for path in here.rglob("*.yaml")}
    assert Path("suites/standard.yaml") in names
    assert {path.relative_to(there) for path in there.rglob("*.yaml")} == names


def test_a_checkout_has_them_beside_the_package():
    assert Path(cgff_cli.shipped("prism")) == ROOT / "structures" / "prism.yaml"
    with pytest.raises(cgff_cli.CgffError, match=r"no scene tensegrity.yaml comes with this installation"):
        cgff_cli.shipped("tensegrity")


def test_the_pages_beside_the_rooms_stay_in_the_clone(installed: Path):
    assert list((ROOT / "cgff_cli").rglob("*.md"))
    assert not list((installed / "cgff_cli").rglob("*.md"))


def test_what_the_page_of_view_is_made_of_is_in_the_package(installed: Path):
    names = {path.name for path in (ROOT / "cgff_cli" / "report").glob("view*.*")}
    assert {"view.html", "view.css", "view.js", "view_world.js"} <= names
    assert all((installed / "cgff_cli" / "report" / name).exists() for name in names)
