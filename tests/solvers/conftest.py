"""What several tests of the solvers share."""

import pytest

from cgff_cli.mechanics import connectivity


@pytest.fixture
def every_scene_is_large(monkeypatch):
    """Send scenes of any size down the sparse path."""
    monkeypatch.setattr(connectivity, "DENSE_ENTRIES", -1)
