"""The one rule for outputs: in which form; over no file that is read, none twice, none that is refused."""

import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence

import click

from cgff_cli.hints import either
from cgff_cli.report.files import STDOUT, check_target, is_stream, make_folder

Named = tuple[str, str]
"""The path of a file, and what it is in words."""

Identity = tuple[int, int] | str
"""Device and inode of a file; of one that is yet to be written, its path."""

TABLE = {".json": "everything", ".csv": "a table"}


def form_of_file(flag: str, path: str, contents: Mapping[str, str], name: str = "the name") -> str | None:
    """Return the form that a file's suffix asks for, such as "json"; None for a device or pipe without one.

    contents : the suffixes allowed, each with what such a file gets, or "" where that goes without saying
    name     : what must end in one of them, in words

    Raises UsageError where the name ends in none of them.
    """
    for suffix in contents:
        if path.lower().endswith(suffix):
            return suffix[1:]
    if is_stream(path):
        return None
    words = [f"{suffix} ({what})" if what else suffix for suffix, what in contents.items()]
    raise click.UsageError(f"{flag} {path}: {name} must end in {either(words)}")


def form_of_data(
    asked: str | None, path: str | None, contents: Mapping[str, str] = TABLE, otherwise: str = ""
) -> str:
    """Return the form of what -o or standard output gets: by suffix, by --format, or by who reads it.

    otherwise : what anyone reads who asks for nothing

    Raises UsageError where --format asks for another form of the file than its name.
    """
    if path in (None, STDOUT):
        return asked or otherwise or ("table" if sys.stdout.isatty() else "json")
    form, asked = form_of_file("-o", str(path), contents), form_for_file(asked, contents)
    if None not in (asked, form) and asked != form:
        raise click.UsageError(f"--format {asked} and -o {path} disagree")
    return form or asked or otherwise or "json"


def form_for_file(asked: str | None, contents: Mapping[str, str]) -> str | None:
    """Return the --format asked for where a file can have it; any other, as a page, is not the file's."""
    return asked if f".{asked}" in contents else None


def data_outputs(
    asked: str | None, path: str | None, contents: Mapping[str, str] = TABLE
) -> list[tuple[str, str]]:
    """Return where the data of a command goes, and in which form: to -o, else to standard output.

    A --format that no file has, such as table, goes to standard output while the file gets the data.
    """
    own = (path or STDOUT, form_of_data(asked, path, contents))
    if path in (None, STDOUT) or asked is None or asked == form_for_file(asked, contents):
        return [own]
    return [own, (STDOUT, asked)]


def check_targets(
    asked: Iterable[tuple[str | None, str]], inputs: Iterable[Named] = (), folder: str | None = None
) -> list[Named]:
    """Refuse, before any work, what would be written over something of this run, or not at all.

    Return the targets that are files, without those not asked for, devices and pipes.

    inputs : asked for only where a target exists already: nothing else can be one of them
    folder : made where it is missing, once nothing speaks against the rest

    Raises UsageError, and CgffError where the system refuses.
    """
    targets = [(path, what) for path, what in asked if path and path != STDOUT and not is_stream(path)]
    taken: dict[Identity, str] = {}
    for path, what in targets:
        own = _identity(path)
        if own in taken:
            raise click.UsageError(f"{path} would be written over {taken[own]}")
        taken[own] = what
    refuse_inputs(targets, inputs)
    if folder is not None:
        make_folder(folder)
    for path, _ in targets:
        check_target(path)
    return targets


def refuse_inputs(targets: Sequence[Named], inputs: Iterable[Named]) -> None:
    """Raise UsageError where a target is one of the files read, by whatever name."""
    existing = {_identity(path): path for path, _ in targets if os.path.exists(path)}
    for path, what in inputs if existing else ():
        if _identity(path) in existing:
            raise click.UsageError(f"{existing[_identity(path)]} would be written over {what}")


def files_of(scenes: Iterable[str]) -> Iterator[Named]:
    """Yield the files that scenes are read from; those of pipes are known once they are read."""
    from cgff_cli.scene.read import tables_of

    for scene in scenes:
        if scene != STDOUT and not is_stream(scene):
            yield scene, f"the scene {scene}"
            yield from ((table, f"a table of {scene}") for table in tables_of(scene))


def _identity(path: str) -> Identity:
    try:
        status = os.stat(path)
    except OSError:
        return os.path.realpath(path)
    except ValueError:  # no file has a name with a null in it
        return path
    return status.st_dev, status.st_ino
