"""Two versions of the program in one process, so that both are measured in the same minute.

Modules are found by name: a version's own are put in place before it is called, outside the clock.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


class Version:
    """The package below one folder, a checkout's root."""

    def __init__(self, root):
        self.root, self.modules = str(Path(root).resolve()), {}

    def __enter__(self):
        self.put_aside = _own()
        sys.path.insert(0, self.root)
        sys.modules.update(self.modules)
        return self

    def __exit__(self, *failure):
        sys.path.remove(self.root)
        self.modules = _own()
        sys.modules.update(self.put_aside)


def _own():
    """Return the modules of whichever version is in place, and take them out."""
    return {name: sys.modules.pop(name) for name in list(sys.modules) if name.split(".")[0] == "cgff_cli"}
