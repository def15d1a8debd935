"""Fixed rulers for speed: what "one linear solve" is, and the Newtons that a user would write in an evening.

Every function takes plain arrays: X (n, d) start, start and end (b,) node rows, k (b,) with force =
k (l - l0), l0 (b,), cable (b,) bool, free (n, d) bool, F (n, d) loads. They are rulers, not parts: nothing
here is imported by the program, and nothing here is tuned for one scene. Run with one BLAS thread; compare by
CPU time, in turn, medians.
"""

from time import process_time

import numpy as np


class Model:
    """Energy, gradient and tangent by scatter-free matrix products; dense."""

    def __init__(self, X, start, end, k, l0, cable, free, F):
        self.n, self.d = X.shape
        self.k, self.l0, self.cable, self.X0 = k, l0, cable, X
        self.C = np.zeros((len(k), self.n))
        e = np.arange(len(k))
        self.C[e, start], self.C[e, end] = 1.0, -1.0
        self.f = np.flatnonzero(free.ravel())
        self.all = len(self.f) == X.size
        self.F = F

    def at(self, x):
        X = self.X0.copy()
        X.reshape(-1)[self.f] = x
        V = self.C @ X
        l = np.sqrt(np.einsum("ij,ij->i", V, V))
        s = l - self.l0
        t = self.k * np.where(self.cable & (s < 0.0), 0.0, s)
        g = (self.C.T @ ((t / l)[:, None] * V) - self.F).reshape(-1)
        return (
            (g if self.all else g[self.f]),
            0.5 * float(t @ (t / self.k)) - float(np.vdot(self.F, X)),
            (V, l, t),
        )

    def tangent(self, inner):
        V, l, t = inner
        q = t / l
        n, d = self.n, self.d
        W = ((V / l[:, None])[:, None, :] * self.C[:, :, None]).reshape(len(l), n * d)
        K = W.T @ (np.where(self.cable & (t <= 0.0), 0.0, self.k - q)[:, None] * W)
        D = self.C.T @ (q[:, None] * self.C)
        blocks = K.reshape(n, d, n, d)
        for a in range(d):
            blocks[:, a, :, a] += D
        return K if self.all else K[np.ix_(self.f, self.f)]


def dense_newton(*arrays, tolerance=1e-10):
    """Return (n, d) coordinates: shifted Newton, Cholesky, decrease of energy or gradient accepted."""
    from scipy.linalg import lapack

    m = Model(*arrays)
    x = m.X0.reshape(-1)[m.f].copy()
    g, E, inner = m.at(x)
    size = float(np.median(m.k))
    low = 1e-10 * size
    mu = low
    load = float(np.abs(m.F).max())
    while np.abs(g).max() > tolerance * max(float(np.abs(inner[2]).max()), load):
        K = m.tangent(inner)
        while True:
            M = K.copy()
            M.reshape(-1)[:: len(M) + 1] += mu
            c, info = lapack.dpotrf(M, lower=1)
            if info == 0:
                dx = lapack.dpotrs(c, -g, lower=1)[0]
                gn, En, there = m.at(x + dx)
                if (
                    En <= E + 1e-4 * float(g @ dx)
                    or np.abs(gn).max() < 0.5 * np.abs(g).max()
                    or abs(En - E) < 1e-12 * abs(E)
                ):
                    break
            mu = max(mu * 10.0, 1e-4 * size)
        x, g, E, inner = x + dx, gn, En, there
        mu = max(low, mu / 10.0 if mu > 1e-5 * size else low)
    X = m.X0.copy()
    X.reshape(-1)[m.f] = x
    return X


def linear_solve(X, start, end, k, l0, cable, free, F, repeat=3):
    """Return the unit of cost for large scenes in CPU seconds.

    One SuperLU factor of rho^T diag(k) rho over the nodes that move (MMD on A^T + A, symmetric mode, scipy's
    default panel) and d triangular solves.
    """
    import scipy.sparse as sp
    import scipy.sparse.linalg as sla

    moves = free.any(axis=1)
    b = len(k)
    C = sp.csr_matrix(
        (np.tile([1.0, -1.0], b), (np.repeat(np.arange(b), 2), np.column_stack((start, end)).ravel())),
        shape=(b, len(X)),
    )[:, moves]
    A = (C.T @ sp.diags(k) @ C).tocsc()
    A += 1e-12 * float(k.max()) * sp.identity(A.shape[0], format="csc")
    rhs = np.ones(A.shape[0])
    best = float("inf")
    for _ in range(repeat):
        t = process_time()
        lu = sla.splu(A, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, diag_pivot_thresh=0.0)
        for _ in range(X.shape[1]):
            lu.solve(rhs)
        best = min(best, process_time() - t)
    return best


def sparse_newton(X, start, end, k, l0, cable, free, F, tolerance=1e-10, most=300, factor=None):
    """Return (coordinates, Newton steps): dense_newton with a sparse tangent.

    `factor(A)` gives an object with .solve, or None where A is not definite; default SuperLU, whose U must
    have a positive diagonal.
    """
    import scipy.sparse as sp
    import scipy.sparse.linalg as sla

    def superlu(A):
        try:
            lu = sla.splu(
                A, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, diag_pivot_thresh=0.0
            )
        except RuntimeError:
            return None
        return lu if np.all(lu.U.diagonal() > 0.0) else None

    factor = factor or superlu
    n, d = X.shape
    f = np.flatnonzero(free.ravel())
    b = len(k)
    C = sp.csr_matrix(
        (np.tile([1.0, -1.0], b), (np.repeat(np.arange(b), 2), np.column_stack((start, end)).ravel())),
        shape=(b, n),
    )
    CT = C.T.tocsr()
    dof = np.stack([start[:, None] * d + np.arange(d), end[:, None] * d + np.arange(d)], 1).reshape(b, 2 * d)
    new = np.full(n * d, -1)
    new[f] = np.arange(len(f))
    I, J = new[np.repeat(dof, 2 * d, 1).ravel()], new[np.tile(dof, (1, 2 * d)).ravel()]
    keep = np.flatnonzero((I >= 0) & (J >= 0))
    code, place = np.unique(J[keep] * len(f) + I[keep], return_inverse=True)  # the pattern, once
    indices, indptr = code % len(f), np.searchsorted(code // len(f), np.arange(len(f) + 1))
    diagonal = np.flatnonzero(code // len(f) == indices)
    sign = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.ones((d, d)))

    def at(x):
        Y = X.copy()
        Y.reshape(-1)[f] = x
        V = C @ Y
        l = np.sqrt(np.einsum("ij,ij->i", V, V))
        s = l - l0
        t = k * np.where(cable & (s < 0.0), 0.0, s)
        return (
            (CT @ ((t / l)[:, None] * V) - F).reshape(-1)[f],
            0.5 * float(t @ (t / k)) - float(np.vdot(F, Y)),
            (V / l[:, None], t, t / l),
        )

    def tangent(u, t, q):
        B = np.where(cable & (t <= 0.0), 0.0, k - q)[:, None, None] * u[:, :, None] * u[:, None, :] + q[
            :, None, None
        ] * np.eye(d)
        return np.bincount(place, (np.tile(B, (1, 2, 2)) * sign).ravel()[keep], minlength=len(code))

    x = X.reshape(-1)[f].copy()
    g, E, inner = at(x)
    size = float(np.median(k))
    low = 1e-10 * size
    mu = low
    load = float(np.abs(F).max())
    steps = 0
    while steps < most:
        if np.abs(g).max() <= tolerance * max(float(np.abs(inner[1]).max()), load):
            break
        K = tangent(*inner)
        for _ in range(40):
            data = K.copy()
            data[diagonal] += mu
            lu = factor(sp.csc_matrix((data, indices, indptr), shape=(len(f), len(f))))
            if lu is not None:
                dx = lu.solve(-g)
                gn, En, there = at(x + dx)
                if (
                    En <= E + 1e-4 * float(g @ dx)
                    or np.abs(gn).max() < 0.5 * np.abs(g).max()
                    or abs(En - E) < 1e-12 * abs(E)
                ):
                    break
            mu = max(mu * 10.0, 1e-4 * size)
        x, g, E, inner = x + dx, gn, En, there
        mu = max(low, mu / 10.0 if mu > 1e-5 * size else low)
        steps += 1
    Y = X.copy()
    Y.reshape(-1)[f] = x
    return Y, steps
