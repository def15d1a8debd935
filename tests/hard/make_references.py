"""Write references.yaml: what the hard scenes must give, to 30 digits.

    python tests/hard/make_references.py [ID...]

Closed forms are evaluated as written. Shapes come from a descent in double precision, then Newton in 60
digits until the forces balance to 1e-40 of the largest. Mechanics are written anew here: cgff reads the
scenes, and solves none of them. With names, only those entries are made anew.
"""

import sys
from pathlib import Path
from typing import Any, NamedTuple

import mpmath
import numpy as np
import yaml
from mpmath import mp, mpf

sys.path.insert(0, str(Path(__file__).parents[2]))

from cgff_cli.scene.scene import AXES
from tests.hard.cases import FOLDER, Case, built, cases, references

mp.dps = 60
BALANCED = mpf("1e-40")
ALL_IN_60_DIGITS = 45
MOST_DISTANCES = 30
MOST_FORCES = 40
FIELDS = ("lengths", "forces", "energy", "distances", "nodes")


class Body(NamedTuple):
    """A scene as lists of exact numbers, and as arrays of doubles; k and l0 per element."""

    names: tuple[str, ...]
    X: np.ndarray
    ends: np.ndarray
    k: list[Any]
    rest: list[Any]
    cable: np.ndarray
    free: np.ndarray
    loads: np.ndarray


def body(scene: Any) -> Body:
    """Return the columns of a scene."""
    n, d = scene.coordinates.shape
    k, rest, cable = [], [], []
    for group in scene.groups:
        for EA, l0 in zip(group.EA.tolist(), group.rest_length.tolist(), strict=True):
            k.append(mpf(EA) if scene.law == "paper" else mpf(EA) / mpf(l0))
            rest.append(mpf(l0))
            cable.append(group.kind == "cable")
    free, loads = np.ones((n, d), dtype=bool), np.zeros((n, d))
    for row, axes in scene.supports.items():
        free[row, [AXES.index(axis) for axis in axes]] = False
    for row, load in scene.loads.items():
        loads[row] = load
    ends = np.concatenate([group.pairs for group in scene.groups])
    return Body(scene.node_names, scene.coordinates, ends, k, rest, np.array(cable), free, loads)


def doubles(b: Body, X: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Return energy, gradient and Hessian over the free directions, in double precision."""
    k, rest = np.array(b.k, dtype=float), np.array(b.rest, dtype=float)
    n, d = X.shape
    i, j = b.ends.T
    V = X[i] - X[j]
    l = np.maximum(np.linalg.norm(V, axis=1), 1e-300)
    on = ~(b.cable & (l < rest))
    stretch = np.where(on, l - rest, 0.0)
    u = V / l[:, None]
    pull = (k * stretch)[:, None] * u
    g = -b.loads.copy()
    np.add.at(g, i, pull)
    np.add.at(g, j, -pull)
    across = k * stretch / l
    across[rest == 0.0] = k[rest == 0.0]
    blocks = (k * on - across)[:, None, None] * u[:, :, None] * u[:, None, :]
    blocks += across[:, None, None] * np.eye(d)
    K = np.zeros((n, d, n, d))
    for p, q, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
        np.add.at(K, (p[:, None, None], np.arange(d)[:, None], q[:, None, None], np.arange(d)), sign * blocks)
    dofs = np.flatnonzero(b.free)
    K = K.reshape(n * d, n * d)[np.ix_(dofs, dofs)]
    return float(0.5 * (k * stretch**2).sum() - (b.loads * X).sum()), g.reshape(-1)[dofs], K


def idle_motions(b: Body, X: np.ndarray) -> np.ndarray:
    """Return orthonormal motions of parts without support: translations, and turns where no load resists."""
    n, d = X.shape
    part = np.arange(n)
    for _ in range(n):
        for i, j in b.ends:
            part[i] = part[j] = min(part[i], part[j])
    columns = []
    for label in set(part.tolist()):
        rows = part == label
        if not b.free[rows].all():
            continue
        Y = np.where(rows[:, None], X - X[rows].mean(axis=0), 0.0)
        columns += [np.outer(rows, axis) for axis in np.eye(d)]
        if not b.loads[rows].any():
            for p in range(d):
                for q in range(p):
                    turn = np.zeros((n, d))
                    turn[:, p], turn[:, q] = Y[:, q], -Y[:, p]
                    columns.append(turn / (np.abs(Y).max() or 1.0))
    dofs = np.flatnonzero(b.free)
    M = np.array([column.reshape(-1)[dofs] for column in columns]).reshape(len(columns), len(dofs)).T
    if not M.size:
        return M
    left, values, _ = np.linalg.svd(M, full_matrices=False)
    return left[:, values > 1e-9]


def descended(b: Body, X: np.ndarray) -> np.ndarray:
    """Return a minimum of the energy near X: Newton with the moduli of eigenvalues, halved steps."""
    size = max(np.ptp(X, axis=0).max(), max(map(float, b.rest)))
    X = X + 1e-3 * size * np.random.default_rng(1).uniform(-1, 1, X.shape) * b.free
    shift = 1e-3
    P, g, K = doubles(b, X)
    for _ in range(3000):
        values, vectors = np.linalg.eigh(K)
        scale = max(np.abs(values).max(), float(max(b.k)))
        floor = np.maximum(np.abs(values), 1e-13 * scale) + shift * scale
        step = np.zeros(X.size)
        step[np.flatnonzero(b.free)] = -vectors @ ((vectors.T @ g) / floor)
        step *= min(1.0, 0.3 * size / (np.abs(step).max() + 1e-300))
        trial = X + step.reshape(X.shape)
        new = doubles(b, trial)
        falls = new[0] < P
        flat = new[0] <= P + 1e-13 * abs(P) and np.linalg.norm(new[1]) < np.linalg.norm(g)
        if falls or flat:
            X, (P, g, K) = trial, new
            shift *= 0.1
        else:
            shift = max(shift, 1e-16) * 10.0
        if np.abs(step).max() < 1e-15 * size or shift > 1e8:
            break
    return X


def exact_forces(b: Body, X: list[list[Any]]) -> tuple[list[list[Any]], list[Any], list[Any]]:
    """Return out-of-balance forces (n, d), lengths and element forces (b,), in 60 digits."""
    eta = [[mpf(float(part)) for part in row] for row in b.loads]
    lengths, forces = [], []
    for e, (i, j) in enumerate(b.ends.tolist()):
        V = [q - p for p, q in zip(X[i], X[j], strict=True)]
        l = mpmath.sqrt(sum(part * part for part in V))
        t = mpf(0) if b.cable[e] and l < b.rest[e] else b.k[e] * (l - b.rest[e])
        lengths.append(l)
        forces.append(t)
        if t != 0:
            for axis, part in enumerate(V):
                eta[i][axis] += t * part / l
                eta[j][axis] -= t * part / l
    return eta, lengths, forces


def exact_tangent(b: Body, X: list[list[Any]], lengths: list[Any], forces: list[Any]) -> Any:
    """Return the Hessian over all directions in 60 digits."""
    d = len(X[0])
    K = mpmath.zeros(len(X) * d)
    for e, (i, j) in enumerate(b.ends.tolist()):
        if b.cable[e] and lengths[e] < b.rest[e]:
            continue
        u = [(p - q) / lengths[e] for p, q in zip(X[i], X[j], strict=True)]
        q = forces[e] / lengths[e]
        for r in range(d):
            for c in range(d):
                value = (b.k[e] - q) * u[r] * u[c] + (q if r == c else 0)
                for p, o, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                    K[p * d + r, o * d + c] += sign * value
    return K


def polished(b: Body, start: np.ndarray) -> list[list[Any]]:
    """Return the balanced shape by Newton in 60 digits; raises where it does not settle."""
    X = [[mpf(float(x)) for x in row] for row in start]
    dofs, d = np.flatnonzero(b.free).tolist(), start.shape[1]
    idle = idle_motions(b, start)
    for _ in range(60):
        eta, lengths, forces = exact_forces(b, X)
        wrong = [eta[dof // d][dof % d] for dof in dofs]
        unit = max([abs(t) for t in forces] + [abs(mpf(float(p))) for p in b.loads.flat])
        unit = max(unit, mpf("1e-8") * max(k * l for k, l in zip(b.k, lengths, strict=True)))
        if max(map(abs, wrong)) <= BALANCED * unit:
            return X
        if len(dofs) <= ALL_IN_60_DIGITS:
            K = exact_tangent(b, X, lengths, forces)
            A = mpmath.matrix([[K[r, c] for c in dofs] for r in dofs])
            A += mpmath.matrix((idle @ idle.T).tolist()) * max(b.k) if idle.size else 0 * A
            step = list(mpmath.lu_solve(A, mpmath.matrix(wrong)))
        else:
            _, _, K = doubles(b, np.array(X, dtype=float))
            K += float(max(b.k)) * (idle @ idle.T) if idle.size else 0.0
            most = max(map(abs, wrong))
            step = [most * mpf(p) for p in np.linalg.solve(K, np.array([float(w / most) for w in wrong]))]
        for dof, part in zip(dofs, step, strict=True):
            X[dof // d][dof % d] += part
    raise ArithmeticError(f"no balance in 60 digits: {mpmath.nstr(max(map(abs, wrong)) / unit, 3)}")


def solved(case: Case, b: Body) -> dict[str, Any]:
    """Return lengths, forces, energy, distances or nodes, and the softest stiffness of one scene."""
    start = b.X if case.near is None else np.array(case.near, dtype=float)
    centre = np.where(b.free.all(), start.mean(axis=0), np.round(start.mean(axis=0)))
    local = b._replace(X=start - centre)  # exact: a far origin has the same neighbours
    near = local.X if case.reference == "newton" else descended(local, local.X)
    X = polished(local, near)
    _, lengths, forces = exact_forces(local, X)
    worked = sum(mpf(float(p)) * (x + mpf(float(c))) for row, at in zip(b.loads, X, strict=True)
                 for p, x, c in zip(row, at, centre, strict=True))  # fmt: skip
    energy = sum(t * t / k for t, k in zip(forces, b.k, strict=True)) / 2 - worked
    found = {"lengths": lengths, "forces": forces, "energy": energy}
    if len(forces) > MOST_FORCES:
        del found["forces"]
    if len(X) <= MOST_DISTANCES and (b.free.all() or len(X) < 9):
        found["distances"] = [
            mpmath.sqrt(sum((p - q) ** 2 for p, q in zip(X[i], X[j], strict=True)))
            for i in range(len(X))
            for j in range(i + 1, len(X))
        ]
    if not b.free.all() and idle_motions(b, b.X).size == 0:
        found["nodes"] = {
            name: [x + mpf(float(c)) for x, c in zip(at, centre, strict=True)]
            for name, at, free in zip(b.names, X, b.free, strict=True)
            if free.any()
        }
    _, _, K = doubles(local, np.array(X, dtype=float))
    idle = idle_motions(local, np.array(X, dtype=float))
    K += np.abs(K).max() * (idle @ idle.T) if idle.size else 0.0
    values = np.linalg.eigvalsh(K)
    found["softest"] = mpf(float(np.abs(values).min()))
    found["sign"] = (
        "unstable"
        if values[0] < -1e-13 * values[-1]
        else "stable"
        if values[0] > 1e-13 * values[-1]
        else "neutral"
    )
    return found


def chain_by_shooting(b: Body) -> dict[str, Any]:
    """Return the shape of a chain between two supports: the first link's force decides all others."""
    links, target = len(b.k), [mpf(float(x)) for x in b.X[-1] - b.X[0]]
    loads = [[mpf(float(p)) for p in row] for row in b.loads]
    weight = -sum(row[1] for row in loads)
    T0 = [weight / 3, -weight / 2]
    for _ in range(200):
        T, X, J, places = list(T0), [mpf(0), mpf(0)], mpmath.zeros(2), []
        energy = mpf(0)
        for e in range(links):
            size = mpmath.sqrt(T[0] ** 2 + T[1] ** 2)
            u = [T[0] / size, T[1] / size]
            for r in range(2):
                X[r] += (b.rest[e] + size / b.k[e]) * u[r]
                for c in range(2):
                    J[r, c] += b.rest[e] / size * ((r == c) - u[r] * u[c]) + (mpf(r == c) / b.k[e])
            energy += size * size / b.k[e] / 2 - (loads[e + 1][0] * X[0] + loads[e + 1][1] * X[1])
            places.append(list(X))
            T = [T[0] - loads[e + 1][0], T[1] - loads[e + 1][1]]
        miss = [X[0] - target[0], X[1] - target[1]]
        if max(map(abs, miss)) < BALANCED * abs(target[0]):
            origin = [mpf(float(x)) for x in b.X[0]]
            nodes = {
                b.names[e + 1]: [o + x for o, x in zip(origin, places[e], strict=True)]
                for e in range(24, links - 1, 25)
            }
            return {"nodes": nodes, "energy": energy}
        step = mpmath.lu_solve(J, mpmath.matrix(miss))
        ratio = max(abs(step[0]), abs(step[1])) / (mpf("0.5") * abs(T0[0]))
        damp = 1 if ratio < 1 else 1 / ratio
        T0 = [T0[0] - damp * step[0], T0[1] - damp * step[1]]
    raise ArithmeticError("the chain does not meet its support")


def evaluated(value: Any) -> Any:
    """Return formulas evaluated, lists and mappings of them likewise."""
    if isinstance(value, dict):
        return {key: evaluated(part) for key, part in value.items()}
    if isinstance(value, list):
        return [evaluated(part) for part in value]
    return mpf(eval(value, {**vars(mpmath), "mpf": mpf, "pi": mp.pi}))


def check(case: Case, b: Body, closed: dict[str, Any], found: dict[str, Any]) -> None:
    """Raise where formulas and digits differ by more than the digits of the scene's data."""
    most = mpf(10) ** -case.expect.get("data_digits", 15)
    group_of = []
    for group in built(case.scene).groups:
        group_of += [group.name] * len(group.EA)
    size = max(found["lengths"])
    for name, length in closed.get("group_lengths", {}).items():
        for own, l in zip(group_of, found["lengths"], strict=True):
            if own == name and abs(l - length) > most * size:
                raise ArithmeticError(
                    f"{case.id}: {name} {mpmath.nstr(l, 20)} is not {mpmath.nstr(length, 20)}"
                )
    for name, place in closed.get("nodes", {}).items():
        miss = max(abs(p - q) for p, q in zip(place, found["nodes"][name], strict=True))
        if miss > most * size:
            raise ArithmeticError(f"{name} is off by {mpmath.nstr(miss, 3)}")
    for t, own in zip(closed.get("forces", ()), found.get("forces", ()), strict=False):
        if abs(t - own) > most * max(map(abs, found["forces"])) * 100:
            raise ArithmeticError(f"force {mpmath.nstr(own, 20)} is not {mpmath.nstr(t, 20)}")


def reference(case: Case) -> dict[str, Any] | None:
    """Return one entry of references.yaml, or None where only the outcome is known."""
    if case.reference == "none":
        return None
    closed = evaluated(case.expect.get("closed", {}))
    if case.reference == "closed":
        return digits(closed)
    b = body(built(case.scene))
    found = chain_by_shooting(b) if case.reference == "chain" else solved(case, b)
    if case.reference != "chain":
        check(case, b, closed, found)
        sign, expected = found.pop("sign"), case.expect["outcome"].split("-")[-1]
        if expected != sign and expected != "neutral":  # the gauge holds floating parts still
            print(f"{case.id}: the sign of the stiffness says otherwise than {case.expect['outcome']}")
    kept = (*case.expect.get("compare", FIELDS), "softest")
    return digits({key: value for key, value in found.items() if key in kept})


def digits(value: Any) -> Any:
    """Return numbers as text of 30 digits, the softest stiffness of 6."""
    if isinstance(value, dict):
        return {
            key: mpmath.nstr(part, 6) if key == "softest" else digits(part) for key, part in value.items()
        }
    if isinstance(value, list):
        return [digits(part) for part in value]
    return mpmath.nstr(value, 30)


def main() -> None:
    asked = sys.argv[1:] or list(cases())
    found = {key: value for key, value in references().items() if key in cases() and key not in asked}
    for name in asked:
        try:
            made = reference(cases()[name])
        except (ArithmeticError, ZeroDivisionError) as error:
            print(f"{name}: {error}")
            continue
        if made is not None:
            found[name] = made
    text = yaml.safe_dump({key: found[key] for key in cases() if key in found}, sort_keys=False, width=110)
    (FOLDER / "references.yaml").write_text(text)


if __name__ == "__main__":
    main()
