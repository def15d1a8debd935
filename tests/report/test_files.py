"""Files appear whole or not at all."""

import os
import pty
import stat
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from cgff_cli.errors import CgffError
from cgff_cli.report.files import write_output


def _failing(error: BaseException) -> Iterator[str]:
    yield "half a resu"
    raise error


def test_a_file_holds_what_was_written(tmp_path: Path):
    write_output(str(tmp_path / "out"), ["é, ", "one\n"])
    assert (tmp_path / "out").read_bytes() == "é, one\n".encode()


@pytest.mark.parametrize("error", [ValueError("broken"), KeyboardInterrupt()])
def test_a_failing_writer_leaves_the_older_file_and_no_other(tmp_path: Path, error: BaseException):
    (tmp_path / "out").write_text("old")
    with pytest.raises(type(error)):
        write_output(str(tmp_path / "out"), _failing(error))
    assert (tmp_path / "out").read_text() == "old"
    assert os.listdir(tmp_path) == ["out"]


def test_a_failing_writer_leaves_nothing_where_nothing_was(tmp_path: Path):
    with pytest.raises(ValueError, match="broken"):
        write_output(str(tmp_path / "out"), _failing(ValueError("broken")))
    assert os.listdir(tmp_path) == []


def test_the_old_file_stays_until_the_new_one_is_complete(tmp_path: Path):
    target = tmp_path / "out"
    target.write_text("old")
    seen = []

    def pieces() -> Iterator[str]:
        yield "new"
        seen.append(target.read_text())

    write_output(str(target), pieces())
    assert (seen, target.read_text()) == (["old"], "new")


def test_a_new_file_has_the_permissions_umask_asks_for(tmp_path: Path):
    before = os.umask(0o027)
    try:
        write_output(str(tmp_path / "out"), ["new"])
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == 0o640


def test_an_older_file_keeps_its_permissions(tmp_path: Path):
    (tmp_path / "out").write_text("old")
    (tmp_path / "out").chmod(0o600)
    write_output(str(tmp_path / "out"), ["new"])
    assert stat.S_IMODE((tmp_path / "out").stat().st_mode) == 0o600


def test_a_link_stays_a_link(tmp_path: Path):
    (tmp_path / "link").symlink_to("real")
    write_output(str(tmp_path / "link"), ["new"])
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_a_missing_folder_is_named(tmp_path: Path):
    with pytest.raises(CgffError, match=r"there is no folder .*nowhere"):
        write_output(str(tmp_path / "nowhere" / "out"), ["new"])


def test_a_folder_is_no_file(tmp_path: Path):
    with pytest.raises(CgffError, match="it is a folder"):
        write_output(str(tmp_path), ["new"])


def test_a_device_is_written_straight():
    # A terminal of our own: were it taken for a file, nothing could be put in its place.
    ours, theirs = pty.openpty()
    write_output(os.ttyname(theirs), ["shown"])
    assert os.read(ours, 100) == b"shown"


def test_a_pipe_with_a_name_is_written_straight(tmp_path: Path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_output(str(pipe), ["through"])
    reader.join(timeout=10)
    assert read == ["through"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_standard_output_is_a_dash(capsys: pytest.CaptureFixture[str]):
    write_output("-", ["one ", "two\n"])
    assert capsys.readouterr().out == "one two\n"


def test_text_that_utf_8_cannot_hold_is_spelled_out(tmp_path: Path):
    write_output(str(tmp_path / "out"), ["\ud800"])
    assert (tmp_path / "out").read_text() == "\\ud800"
