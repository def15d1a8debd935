"""What was worked out, by digest, in a file that grows by a line each time: a run cut short goes on there."""

import json
from typing import Any

from cgff_cli.errors import CgffError


class Journal(dict[str, Any]):
    """Digest -> plain values; an entry set is in the file before the next one is worked out.

    Raises CgffError where the system refuses.
    """

    def __init__(self, path: str):
        self.path = path
        super().__init__(_entries(path))

    def __setitem__(self, digest: str, value: Any) -> None:
        super().__setitem__(digest, value)
        try:
            with open(self.path, "a", encoding="utf-8") as file:
                # A line of its own, whatever a run that was killed left of its last one.
                file.write(f"\n{json.dumps([digest, value])}")
        except OSError as error:
            raise CgffError(f"{self.path}: cannot be written: {error.strerror or error}") from error


def _entries(path: str) -> dict[str, Any]:
    """Return what a file holds, the last of each digest; none where there is no file."""
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            lines = file.readlines()
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise CgffError(f"{path}: cannot be read: {error.strerror or error}") from error
    found = {}
    for line in lines:
        try:
            digest, value = json.loads(line)
        except (ValueError, TypeError):  # an empty line, or one that was cut off
            continue
        found[str(digest)] = value
    return found
