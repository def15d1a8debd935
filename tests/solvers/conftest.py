"""What several tests of the solvers share."""

import pytest

from cgff_cli.mechanics.connectivity import Connectivity


@pytest.fixture
def every_scene_is_large(monkeypatch):
    """Send scenes of any size down the sparse path."""
    init = Connectivity.__init__

    def large(self, start, end, node_count):
        init(self, start, end, node_count)
        self.is_small = False

    monkeypatch.setattr(Connectivity, "__init__", large)
