"""The page of recipes as a shell, make, a job array and pandas run them; what is not installed is skipped."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.pages import ROOT, Block, Page

RECIPES = Page(ROOT / "cgff_cli" / "cli" / "README.md")
TOOLS = ("parallel", "jq", "make", "xargs", "find")


def text_of(kind: str, word: str = "") -> str:
    """Return the only block of a language that holds a word."""
    (found,) = [block.text for block in RECIPES.blocks if block.kind == kind and word in block.text]
    return found


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in a folder with the structures, a command `cgff`, and the files that the page names."""
    shutil.copytree(ROOT / "structures", tmp_path / "structures")
    command = tmp_path / "bin" / "cgff"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m cgff_cli "$@"\n')
    command.chmod(0o755)
    (tmp_path / "sweep.sbatch").write_text(text_of("slurm"))
    (tmp_path / "Makefile").write_text(text_of("make"))
    monkeypatch.setenv("PATH", f"{command.parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def shell(text: str) -> str:
    """Run some lines, which must all succeed and say nothing on standard error; return what they print."""
    lacking = [tool for tool in TOOLS if re.search(rf"\b{tool}\b", text) and shutil.which(tool) is None]
    if lacking:
        pytest.skip(f"{lacking[0]} is not installed")
    ended = subprocess.run(["bash", "-euo", "pipefail", "-c", text], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, ""), text
    return ended.stdout


@pytest.mark.parametrize(
    "block",
    [block for block in RECIPES.blocks if block.kind == "bash" and "sbatch" not in block.text],
    ids=lambda block: block.place,
)
def test_a_recipe_runs(folder: Path, block: Block):
    shell(block.text)
    assert not [path for path in folder.rglob("*.json") if path.stat().st_size == 0]


def test_many_scenes_have_a_result_and_a_line_each(folder: Path):
    shell(text_of("bash", "--summary"))
    names = {path.stem for path in (folder / "structures").glob("*.yaml")}
    assert {path.stem for path in (folder / "results").glob("*.json")} == names
    assert len((folder / "summary.csv").read_text().splitlines()) == 1 + len(names)


def test_make_solves_what_has_changed(folder: Path):
    scenes = len(list((folder / "structures").glob("*.yaml")))
    assert shell("make all").count("cgff solve") == scenes
    assert shell("make all").count("cgff solve") == 0
    os.utime(folder / "results" / "prism.json", (0.0, 0.0))
    assert shell("make all").count("cgff solve structures/prism.yaml -o results/prism.json") == 1


def test_the_shards_of_a_job_array_are_the_whole_table(folder: Path):
    shell(text_of("bash", "--set struts.EA=log:100:1e4:30"))
    shell(text_of("bash", "sbatch"))
    assert len((folder / "rows.csv").read_text().splitlines()) == 1 + 3000


def test_pandas_reads_the_rows(folder: Path):
    pytest.importorskip("pandas")
    shell(text_of("bash", "--set struts.EA=log:100:1e4:30"))
    ended = subprocess.run([sys.executable, "-c", text_of("pandas")], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "verticals.rest_length" in ended.stdout
