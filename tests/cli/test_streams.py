"""Standard streams that are closed or full, and Ctrl-C before there is anything to keep."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.test_processes import CGFF, ENVIRONMENT, PRISM

COMMANDS = {
    "solve": ["solve", PRISM],
    "check": ["check", PRISM],
    "compare": ["compare", PRISM, "--fdm", "--repeat", "1"],
    "bench": ["bench", PRISM, "--fdm", "--repeat", "1"],
    "new": ["new", "prism"],
    "help": ["--help"],
    "help of a command": ["solve", "--help"],
    "version": ["--version"],
}
REFUSED = {"nowhere.yaml": 3, "--tolerance=2": 2}

every_command = pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS)


def _redirected(command: list[str], redirection: str) -> tuple[int, str]:
    """Return exit code and what was written to standard error."""
    shell = ["sh", "-c", f'exec "$@" {redirection}', "sh", *CGFF, *command]
    ended = subprocess.run(shell, capture_output=True, env=ENVIRONMENT, text=True, stdin=subprocess.DEVNULL)
    return ended.returncode, ended.stderr


@every_command
def test_a_standard_output_that_cannot_be_written_is_1_and_a_line(command: list[str]):
    said = "cgff: standard output: cannot be written: "
    assert _redirected(command, ">&-") == (1, f"{said}Bad file descriptor\n")
    assert _redirected(command, ">/dev/full") == (1, f"{said}No space left on device\n")


def test_a_closed_standard_output_is_closed_by_its_file_name_too():
    said = "cgff: /dev/stdout: cannot be written: Bad file descriptor\n"
    assert _redirected(["solve", PRISM, "-o", "/dev/stdout"], ">&-") == (1, said)
    assert _redirected(["new", "prism", "-o", "/dev/stdout"], ">&-") == (1, said)


def test_standard_output_by_its_file_name_is_added_to_and_not_written_over(tmp_path: Path):
    out = tmp_path / "out"
    out.write_text("before\n")
    assert _redirected(["new", "prism", "-o", "/dev/stdout"], f">> {out}") == (0, "")
    assert out.read_text().startswith("before\n# Prism")


@every_command
def test_words_that_nobody_can_read_change_no_exit_code(command: list[str]):
    assert [_redirected(command, where)[0] for where in ("2>&-", "2>/dev/full", "<&-")] == [0, 0, 0]


@pytest.mark.parametrize(("argument", "code"), REFUSED.items())
def test_nor_do_they_where_the_command_fails(argument: str, code: int):
    command = ["solve", PRISM, argument]
    assert [_redirected(command, where)[0] for where in ("2>&-", "2>/dev/full")] == [code, code]


def test_a_closed_standard_input_is_a_scene_that_cannot_be_read():
    assert _redirected(["solve", "-"], "<&-") == (3, "<stdin>: cannot read the scene: it is closed\n")


@pytest.mark.parametrize("module", ["click", "cgff_cli.cli.solve", "numpy", "cgff_cli.pipeline", "yaml"])
def test_ctrl_c_during_an_import_is_130_and_a_word(module: str):
    program = (
        "import os, runpy, signal, sys\n"
        "class Interrupting:\n"
        "    def find_spec(self, name, *_):\n"
        f"        if name == {module!r}: os.kill(os.getpid(), signal.SIGINT)\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "sys.meta_path.insert(0, Interrupting())\n"
        "runpy.run_module('cgff_cli', run_name='__main__')\n"
    )
    command = [sys.executable, "-c", program, "solve", PRISM]
    ended = subprocess.run(command, capture_output=True, env={**os.environ, **ENVIRONMENT}, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "cgff: interrupted\n")
