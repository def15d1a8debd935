"""The command as a process: pipes, signals, terminals, and what it imports."""

import json
import os
import pty
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from cgff_cli.cli import COMMANDS
from tests.cli.conftest import STRUCTURES

CGFF = [sys.executable, "-m", "cgff_cli"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(STRUCTURES.parent)}
ENVIRONMENT.pop("PYTHONUNBUFFERED", None)  # users' output is buffered
PRISM = str(STRUCTURES / "prism.yaml")


def test_a_result_survives_a_pipe_byte_for_byte():
    scene = Path(PRISM).read_bytes()
    piped = subprocess.run(
        [*CGFF, "solve", "-"], input=scene, capture_output=True, env=ENVIRONMENT, check=True
    )
    result = json.loads(piped.stdout)
    assert result["converged"] is True
    assert list(result["nodes"]) == ["n1", "n2", "n3", "n4", "n5", "n6"]
    assert piped.stderr == b""


def test_a_pipe_named_as_a_file_is_read_once_and_here(tmp_path: Path):
    command = [*CGFF, "solve", "/dev/stdin", PRISM, "--jobs", "2", "--out-dir", "out"]
    for _ in range(2):  # the second time there is a file to be replaced
        subprocess.run(command, input=Path(PRISM).read_bytes(), env=ENVIRONMENT, cwd=tmp_path, check=True)
    assert sorted(path.name for path in (tmp_path / "out").glob("[!.]*")) == ["prism.json", "stdin.json"]


@pytest.mark.parametrize(("flags", "begins"), [([], b"{\n"), (["--format", "csv"], b"name,x,y,z\n")])
def test_a_device_has_no_suffix_and_takes_the_format_asked_for(flags: list[str], begins: bytes):
    command = [*CGFF, "solve", PRISM, "-o", "/dev/stdout", *flags]
    assert subprocess.run(command, capture_output=True, env=ENVIRONMENT).stdout.startswith(begins)


def test_a_redirected_device_is_not_replaced(tmp_path: Path):
    with (tmp_path / "out").open("wb") as out:
        subprocess.run([*CGFF, "solve", PRISM, "-o", "/dev/stdout"], stdout=out, env=ENVIRONMENT, check=True)
        assert os.path.samestat(os.fstat(out.fileno()), os.stat(tmp_path / "out"))
    assert json.loads((tmp_path / "out").read_text())["converged"] is True


def test_a_reader_that_leaves_early_causes_no_complaint(tmp_path: Path):
    scene = _long_chain(tmp_path, 3000)
    solving = subprocess.Popen(
        [*CGFF, "solve", scene, "--max-iterations", "0"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=ENVIRONMENT,
    )
    assert solving.stdout is not None
    assert solving.stderr is not None
    solving.stdout.read(10)
    solving.stdout.close()
    assert solving.stderr.read() == b""
    assert solving.wait() == 141


def test_no_reader_at_all_causes_no_complaint_either():
    read, write = os.pipe()
    os.close(read)
    short = [*CGFF, "solve", PRISM, "--format", "csv"]  # so short that Python still holds it at exit
    ended = subprocess.run(short, stdout=write, stderr=subprocess.PIPE, env=ENVIRONMENT)
    os.close(write)
    assert (ended.returncode, ended.stderr) == (141, b"")


def test_a_full_disk_is_an_error_and_not_a_silent_success():
    if not os.path.exists("/dev/full"):
        pytest.skip("no /dev/full here")
    with open("/dev/full", "w") as full:
        ended = subprocess.run([*CGFF, "solve", PRISM], stdout=full, stderr=subprocess.PIPE, env=ENVIRONMENT)
    assert ended.returncode == 1
    assert ended.stderr == b"cgff: standard output: cannot be written: No space left on device\n"


def test_ctrl_c_writes_the_last_state_and_starts_no_other_scene(tmp_path: Path):
    arguments = [_long_chain(tmp_path, 200), PRISM, "--out-dir", str(tmp_path / "out"), *SLOWLY]
    code, words = _interrupt_when_shown([*CGFF, "solve", *arguments], b"iteration")
    assert code == 130
    assert b"interrupted: " in words
    assert [path.name for path in (tmp_path / "out").glob("[!.]*")] == ["chain.json"]
    result = json.loads((tmp_path / "out" / "chain.json").read_text())
    assert (result["verdict"], result["converged"]) == ("interrupted", False)
    assert len(result["nodes"]) == 201


def test_ctrl_c_writes_the_last_state_of_what_other_processes_have_begun(tmp_path: Path):
    paths = [_long_chain(tmp_path, 200), str(tmp_path / "other.json"), str(tmp_path / "third.json")]
    for path in paths[1:]:
        Path(path).write_bytes(Path(paths[0]).read_bytes())
    arguments = [PRISM, *paths, "--jobs", "2", "--out-dir", str(tmp_path / "out"), *SLOWLY[2:], *SLOWLY[:2]]
    code, words = _interrupt_when_shown([*CGFF, "solve", *arguments], b"1 of 4 scenes")
    assert code == 130
    assert b"Traceback" not in words
    written = [json.loads(path.read_text()) for path in sorted((tmp_path / "out").glob("[!.]*"))]
    assert [result["verdict"] for result in written][-1] == "converged"
    assert {result["verdict"] for result in written[:-1]} <= {"interrupted"}


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_many_scenes_are_counted_on_a_terminal_and_words_have_lines_of_their_own(tmp_path: Path, jobs: str):
    (tmp_path / "double.yaml").write_text(DOUBLE)
    arguments = ["double.yaml", PRISM, "--jobs", jobs, "--out-dir", "out"]
    shown = _on_terminal([*CGFF, "solve", *arguments], ENVIRONMENT, tmp_path).decode()
    assert "\r0 of 2 scenes  " in shown
    assert re.search(r"\r1 of 2 scenes  \d\S*/\w+  \S+ s left", shown)
    lines = [line.rpartition("\r")[2] for line in shown.split("\r\n")]  # as they stay
    assert [line.partition(": warning")[0] for line in lines] == ["cgff: double.yaml", ""]


def test_ctrl_c_leaves_the_cases_already_measured(tmp_path: Path):
    out = tmp_path / "out.json"
    slowly = SLOWLY[2:]  # the methods stand for the objective
    arguments = [PRISM, _long_chain(tmp_path, 200), "--residual", "--repeat", "1", *slowly, "-o", str(out)]
    code, words = _interrupt_when_shown([*CGFF, "bench", *arguments], b"case 2 of 2")
    assert code == 130
    assert b"chain: interrupted" in words
    assert [row["case"] for row in json.loads(out.read_text())["rows"]] == ["prism", "prism"]


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_ctrl_c_keeps_the_equilibria_found(tmp_path: Path, jobs: str):
    out = tmp_path / "found.json"
    arguments = [PRISM, "--starts", "10000000", "--jobs", jobs, "-o", str(out)]
    code, words = _interrupt_when_shown(
        [*CGFF, "equilibria", *arguments], b"of 10000000 starts, distinct equilibria: 1"
    )
    assert code == 130
    assert b"interrupted after" in words
    told = json.loads(out.read_text())
    (only,) = told["equilibria"]
    assert told["interrupted"] is True
    assert 0 < only["count"] == told["starts"] < 10000000


@pytest.mark.parametrize(
    ("arguments", "unwanted"),
    [
        *(
            ([*command, "--help"], {"numpy", "yaml", "rich", "scipy", "json"})
            for command in ([], *([name] for name in COMMANDS))
        ),
        (["solve", PRISM, "-o", "out.json"], {"scipy", "rich", "csv"}),
        (["check", PRISM], {"scipy", "rich", "json"}),
    ],
)
def test_only_what_is_needed_is_imported(tmp_path: Path, arguments: list[str], unwanted: set[str]):
    program = (
        "import sys\n"
        "from cgff_cli.cli import main\n"
        "main(sys.argv[1:], prog_name='cgff', standalone_mode=False)\n"
        "print(*sys.modules, file=sys.stderr)\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        capture_output=True,
        env=ENVIRONMENT,
        cwd=tmp_path,
        text=True,
    )
    loaded = set(ended.stderr.split())
    assert "click" in loaded
    assert loaded & unwanted == set()


def test_a_terminal_gets_a_table_in_colour_unless_no_color_is_set():
    assert b"\x1b[" in _on_terminal([*CGFF, "solve", PRISM], ENVIRONMENT)
    plain = _on_terminal([*CGFF, "solve", PRISM], {**ENVIRONMENT, "NO_COLOR": "1"})
    assert b"Triangular prism" in plain
    assert b"\x1b" not in plain


def test_colour_can_be_asked_for_and_refused():
    assert b"\x1b" not in _on_terminal([*CGFF, "solve", PRISM, "--no-color"], ENVIRONMENT)
    asked = [*CGFF, "--color", "solve", PRISM, "--format", "table"]
    assert b"\x1b[1;32mconverged" in subprocess.run(asked, capture_output=True, env=ENVIRONMENT).stdout


DOUBLE = Path(PRISM).read_text().replace("[n1, n2]", "[n1, n2], [n1, n2]")


def test_a_warning_is_told_once_on_the_page_or_else_on_standard_error(tmp_path: Path):
    scene = tmp_path / "double.yaml"
    scene.write_text(DOUBLE)
    for flags in ([], ["-o", "out.json"]):
        command = [*CGFF, "solve", str(scene), *flags]
        shown = _on_terminal(command, {**ENVIRONMENT, "NO_COLOR": "1"}, tmp_path)
        assert b" ".join(shown.split()).count(b"joined by more than one element") == 1, flags


@pytest.mark.parametrize("width", [40, 60, 80])
def test_a_line_of_check_keeps_to_the_width_of_a_terminal(tmp_path: Path, width: int):
    lines = (
        _on_terminal([*CGFF, "check", PRISM], {**ENVIRONMENT, "COLUMNS": str(width)}).decode().split("\r\n")
    )
    assert max(map(len, lines)) <= width
    assert " ".join("".join(lines).split()).endswith("law paper")


SLOWLY = ["--objective", "residual", "--preconditioner", "none", "--max-iterations", "1e15"]


def _long_chain(folder: Path, count: int) -> str:
    """Write a slack hanging chain, which plain gradients straighten slowly."""
    path = folder / "chain.json"
    scene = {
        "law": "paper",
        "nodes": {f"n{i}": [float(i), 0.0] for i in range(count + 1)},
        "elements": {
            "chain": {
                "kind": "cable",
                "EA": 1.0,
                "rest_length": 0.9,
                "pairs": [[f"n{i}", f"n{i + 1}"] for i in range(count)],
            }
        },
        "supports": {"n0": "xy", f"n{count}": "xy"},
        "loads": {f"n{i}": [0.0, -0.01] for i in range(1, count)},
    }
    path.write_text(json.dumps(scene))
    return str(path)


def _interrupt_when_shown(command: list[str], sign: bytes) -> tuple[int, bytes]:
    """Run with a terminal for standard error, send Ctrl-C once it shows `sign`; return code and words."""
    ours, theirs = pty.openpty()
    solving = subprocess.Popen(
        command, stderr=theirs, stdout=subprocess.DEVNULL, env=ENVIRONMENT, preexec_fn=_heed_ctrl_c
    )
    os.close(theirs)
    shown = _read_until(ours, sign)
    solving.send_signal(signal.SIGINT)
    shown += _read_until(ours, None)
    return solving.wait(timeout=60), shown


def _heed_ctrl_c() -> None:
    """Undo what a shell does to commands in the background, whose children ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def _on_terminal(command: list[str], environment: dict[str, str], folder: Path | None = None) -> bytes:
    ours, theirs = pty.openpty()
    environment = {**environment, "TERM": "xterm-256color"}
    solving = subprocess.Popen(command, stdout=theirs, stderr=theirs, env=environment, cwd=folder)
    os.close(theirs)
    shown = _read_until(ours, None)
    assert solving.wait(timeout=60) == 0
    return shown


def _read_until(terminal: int, sign: bytes | None) -> bytes:
    shown = b""
    while sign is None or sign not in shown:
        try:
            piece = os.read(terminal, 4096)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        shown += piece
    return shown
