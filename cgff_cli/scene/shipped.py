"""The scenes that come with the program, wherever it is installed."""

import os

from cgff_cli.errors import CgffError

PAPER = ("x-module", "hexagon", "prism")
"""The paper's structures, in the order of its Tables II, III and IV."""


def shipped(name: str) -> str:
    """Return the path of a scene that comes with the program, such as "prism"; raises CgffError.

    An installed package holds them in its own folder `structures`, a checkout beside the package.
    """
    package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    folders = [os.path.join(place, "structures") for place in (package, os.path.dirname(package))]
    for folder in folders:
        path = os.path.join(folder, f"{name}.yaml")
        if os.path.isfile(path):
            return path
    raise CgffError(f"no scene {name}.yaml comes with this installation; looked in {' and '.join(folders)}")
