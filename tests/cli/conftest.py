"""The command run in this process: exit code, standard output and standard error apart."""

from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from cgff_cli import pipeline
from cgff_cli.cli import main

STRUCTURES = Path(__file__).parents[2] / "structures"

Run = Callable[..., Result]

UNSTABLE = """\
name: three nodes in line, pushed together
law: paper
nodes: {a: [0, 0], b: [0.9, 0], c: [1.8, 0]}
elements:
  struts: {kind: strut, EA: 1.0, rest_length: 1.0, pairs: [[a, b], [b, c]]}
supports: {a: xy, c: xy}
"""


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run `cgff` with arguments in a folder of its own, which holds prism.yaml and bracket.yaml."""
    for name in ("prism.yaml", "bracket.yaml"):
        (tmp_path / name).write_text((STRUCTURES / name).read_text())
    monkeypatch.chdir(tmp_path)

    def invoke(*arguments: str, stdin: str | None = None) -> Result:
        return CliRunner().invoke(main, arguments, input=stdin, prog_name="cgff")

    return invoke


@pytest.fixture
def bad(tmp_path: Path) -> str:
    """Write a scene with two mistakes and return its path."""
    (tmp_path / "bad.yaml").write_text("law: paper\nnodes: {a: [0, 0], b: [1, 0]}\ncolour: red\n")
    return "bad.yaml"


@pytest.fixture
def unstable(tmp_path: Path) -> str:
    """Write a scene that starts in an unstable equilibrium and return its path."""
    (tmp_path / "unstable.yaml").write_text(UNSTABLE)
    return "unstable.yaml"


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the scenes solved so far."""
    names: list[str] = []
    real = pipeline.solve

    def counted(scene, **options):
        names.append(scene.path)
        return real(scene, **options)

    monkeypatch.setattr(pipeline, "solve", counted)
    return names
