"""What tests may need that is not always there, and one thread each, as the command sets for itself."""

import os
import signal
from importlib.util import find_spec

import pytest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in the background of a script
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items):
    for module in ("cvxopt", "distributed", "matplotlib", "jupyter_threejs_sage", "meshio", "ezdxf"):
        if find_spec(module) is None:
            for item in items:
                if item.get_closest_marker(f"needs_{module}"):
                    item.add_marker(pytest.mark.skip(reason=f"{module} is not installed"))
