"""What tests may need that is not always there."""

from importlib.util import find_spec

import pytest


def pytest_collection_modifyitems(items):
    if find_spec("cvxopt") is not None:
        return
    for item in items:
        if item.get_closest_marker("needs_cvxopt"):
            item.add_marker(pytest.mark.skip(reason="cvxopt is not installed"))
