"""What may have been meant is named where it is clear, and not chosen where it is not."""

import pytest

from cgff_cli.hints import did_you_mean


@pytest.mark.parametrize(
    ("name", "candidates", "hint"),
    [
        ("top4", ["bottom1", "top1"], "; did you mean 'top1'?"),
        ("top4", ["top1", "bottom1", "top2"], "; did you mean 'top1' or 'top2'?"),
        ("n9", ["n1", "n2", "n3"], "; did you mean 'n1', 'n2' or 'n3'?"),
        ("n9", ["n1", "n2", "n3", "n4"], ""),
        ("Cable", ["cable", "strut"], "; did you mean 'cable'?"),
        ("anchor", ["a", "b"], ""),
        ("anything", [], ""),
    ],
)
def test_names_equally_near_are_all_named_or_none_is(name, candidates, hint):
    assert did_you_mean(name, candidates) == hint
