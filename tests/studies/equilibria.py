"""Which stable shapes `equilibria` finds, beside an enumeration that shares nothing with it.

    OPENBLAS_NUM_THREADS=1 python tests/studies/equilibria.py [--starts 2000] [--rival 400] [--only prism]

The rival minimises the energy, as one would write it, by scipy's BFGS from random starts of its own, and
polishes by `fsolve`; a shape is stable where the energy's second derivatives, by complex steps through a loop
over elements, are positive but for rigid motions, and known where all its distances, or its coordinates in a
supported scene, agree to 1e-5. For either: labelled shapes, energies that differ, starts a second of CPU
time; of `equilibria` also kinds, the start that led to the last shape, and how many times longer a loop of
single solves takes. `missed`: shapes of the rival that `equilibria` has not found.
"""

import argparse
import sys
import time
from dataclasses import replace

import numpy as np
from by_loop import nodal_forces
from scipy.optimize import fsolve, minimize
from versions_in_one import ROOT

import cgff_cli
from cgff_cli.structure import from_scene
from cgff_cli.study.starts import random_start, size_of_start

sys.path.insert(0, str(ROOT))
from tests.study.landscapes import as_struts, dome, kresling, row_of_trusses, truss

NEAR = 1e-5
SHIPPED = ("prism", "x-module", "hexagon", "octahedron")


def scenes():
    """Return name -> scene."""
    shipped = {name: cgff_cli.load(str(ROOT / "structures" / f"{name}.yaml")) for name in SHIPPED}
    square = cgff_cli.new("x-tower", stages=1)
    return shipped | {
        "prism, pushing": as_struts(shipped["prism"]),
        "x-module, pushing": as_struts(shipped["x-module"]),
        "square x-module": square,
        "square, pushing": as_struts(square),
        "x-tower of 2": cgff_cli.new("x-tower", stages=2),
        "tower of 3": cgff_cli.new("tower", stages=3),
        "Kresling module": kresling(),
        "truss, loaded": truss(load=1.0),
        "4 trusses in a row": row_of_trusses(4),
        "dome, loaded": dome(load=0.1),
    }


def energy_and_slope(s, X):
    """Return the energy at (n, d) coordinates, and its slope."""
    V = X[s.start] - X[s.end]
    l = np.linalg.norm(V, axis=1)
    e = l - s.rest_lengths
    e[(e < 0.0) & s.tension_only] = 0.0
    pull = V * (s.stiffness * e / l)[:, None]
    slope = -np.array(s.loads)
    np.add.at(slope, s.start, pull)
    np.add.at(slope, s.end, -pull)
    return 0.5 * (s.stiffness * e * e).sum() - (s.loads * X).sum(), slope


def minimised(s, X):
    """Return a shape of no force left over that scipy finds from a start, or None."""
    full = X.copy()

    def of(x):
        full[s.free] = x
        value, slope = energy_and_slope(s, full)
        return value, slope[s.free]

    x = minimize(of, X[s.free], jac=True, method="BFGS", options={"gtol": 1e-9, "maxiter": 5000}).x
    x = fsolve(lambda x: of(x)[1], x, xtol=1e-14, full_output=True)[0]  # it says when it can do no more
    full[s.free] = x
    scale = (s.stiffness * np.linalg.norm(full[s.start] - full[s.end], axis=1)).max()
    return full if np.abs(of(x)[1]).max() < 1e-9 * scale else None


def is_stable(s, X):
    """Return whether second derivatives are positive, apart from rigid motions of a free body."""
    dofs = np.flatnonzero(s.free)
    columns = []
    for dof in dofs:
        step = np.zeros(X.size, dtype=complex)
        step[dof] = 1e-20j
        columns.append(-nodal_forces(s, X + step.reshape(X.shape)).ravel()[dofs].imag / 1e-20)
    d = X.shape[1]
    rigid = d * (d + 1) // 2 if s.free.all() else 0
    values = np.linalg.eigvalsh(np.array(columns))
    return bool(values[0] > -1e-8 * values[-1] and values[rigid] > 1e-8 * values[-1])


def signature(s, X):
    """Return what tells shapes apart: all distances of a free body, coordinates of a supported one."""
    if not s.free.all():
        return X.ravel()
    return np.linalg.norm(X[:, None] - X, axis=2)[np.triu_indices(len(X), 1)]


def among(signatures, own, size):
    return any(np.abs(own - other).max() < NEAR * size for other in signatures)


def enumerated(s, starts):
    """Return signatures and energies of the rival's stable shapes, and CPU seconds a start."""
    size, signatures, energies = size_of_start(s), [], []
    begun = time.process_time()
    for number in range(starts):
        X = minimised(s, random_start(s, 99, number + 1))
        if X is None or among(signatures, signature(s, X), size) or not is_stable(s, X):
            continue
        signatures.append(signature(s, X))
        energies.append(energy_and_slope(s, X)[0])
    return signatures, energies, (time.process_time() - begun) / starts


def different(energies):
    """Return how many energies differ by more than rounding."""
    ordered, scale = np.sort(energies), max(np.abs(energies), default=0.0)
    return int(len(ordered) and 1 + (np.diff(ordered) > 1e-7 * max(scale, 1e-9)).sum())


def by_single_solves(scene, s, count):
    """Return CPU seconds a start of a loop of `solve` from the same random starts."""
    begun = time.process_time()
    for number in range(count):
        cgff_cli.solve(replace(scene, coordinates=random_start(s, 0, number)))
    return (time.process_time() - begun) / count


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=2000)
    parser.add_argument("--rival", type=int, default=400)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    print(f"{'':20}shapes kinds energies  last  a second    loop |  rival energies  a second  missed")
    for name, scene in scenes().items():
        if arguments.only not in name:
            continue
        s = from_scene(scene)
        cgff_cli.equilibria(scene, starts=2)
        begun = time.process_time()
        found = cgff_cli.equilibria(scene, starts=arguments.starts)
        each = (time.process_time() - begun) / arguments.starts
        loop = by_single_solves(scene, s, 60)
        others, energies, rival = enumerated(s, arguments.rival)
        known = [signature(s, own.coordinates) for own in found.shapes]
        missed = sum(not among(known, other, size_of_start(s)) for other in others)
        last = max((own.first_start for own in found.shapes), default=0)
        print(
            f"{name:20}{len(found.shapes):6}{found.kinds:6}{different([o.energy for o in found.shapes]):9}"
            f"{last:6}{1 / each:10.0f}{loop / each:7.1f}x |{len(others):7}{different(energies):9}"
            f"{1 / rival:10.0f}{missed:8}",
            flush=True,
        )


if __name__ == "__main__":
    main()
