"""Sparse factors: both kinds solve, and refuse what is not positive definite."""

import numpy as np
import pytest
from scipy.sparse import csc_array

from cgff_cli.solvers.factors import factory

KINDS = ["superlu", pytest.param("cholmod", marks=pytest.mark.needs_cvxopt)]


def definite(n=40):
    """Return a sparse matrix whose diagonal outweighs its rows."""
    generator = np.random.default_rng(0)
    A = generator.random((n, n)) * (generator.random((n, n)) < 0.1)
    A += A.T
    return csc_array(A + np.diag(A.sum(axis=0) + 1.0))


@pytest.mark.parametrize("kind", KINDS)
def test_a_factor_solves(kind):
    A = definite()
    b = np.sin(np.arange(40.0))
    factor = factory(A.indices, A.indptr, kind).factor(A.data)
    assert A @ factor.solve(b) == pytest.approx(b, abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_an_indefinite_matrix_is_refused(kind):
    A = definite()
    data = A.data.copy()
    columns = np.repeat(np.arange(40), np.diff(A.indptr))
    data[(A.indices == columns) & (columns == 17)] *= -1.0
    assert factory(A.indices, A.indptr, kind).factor(data) is None


@pytest.mark.parametrize("kind", KINDS)
def test_a_singular_matrix_is_refused(kind):
    A = definite()
    assert factory(A.indices, A.indptr, kind).factor(np.zeros_like(A.data)) is None


@pytest.mark.parametrize("kind", KINDS)
def test_a_pattern_is_factored_again_with_other_numbers(kind):
    A = definite()
    made = factory(A.indices, A.indptr, kind)
    made.factor(A.data)
    b = np.cos(np.arange(40.0))
    assert 3.0 * (A @ made.factor(3.0 * A.data).solve(b)) == pytest.approx(b, abs=1e-12)
