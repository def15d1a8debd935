"""VTU, the unstructured grid of VTK: lines with forces and lengths, for ParaView and others; by meshio."""

import os
from importlib.util import find_spec
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.mechanics import elements
from cgff_cli.scene.physics import all_pairs
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import from_scene


def check_meshio() -> None:
    """Raise OptionError unless meshio is installed."""
    if find_spec("meshio") is None:
        raise OptionError("VTU needs meshio, which is not installed: pip install 'cgff-cli[mesh]'")


def vtu_bytes(scene: Scene, start: np.ndarray | None) -> bytes:
    """Return a scene as VTU, compressed, every number in full.

    start : (n, d) coordinates that displacements are counted from, None where there are none

    A cell each element: `group` (its number), `strut` (0 or 1), `length`, `EA`, and but for a geometry
    `rest_length`, `force`, `force_density`, `slack`. A point each node: `displacement`.
    """
    check_meshio()
    import meshio

    points = _in_space(scene.coordinates)
    moved = {} if start is None else {"displacement": points - _in_space(start)}
    data = {name: [values] for name, values in _cell_data(scene).items()}
    mesh = meshio.Mesh(points, [("line", all_pairs(scene.groups))], point_data=moved, cell_data=data)
    with TemporaryDirectory() as folder:  # meshio writes VTU to a name only
        path = os.path.join(folder, "mesh.vtu")
        meshio.write(path, mesh, file_format="vtu")
        with open(path, "rb") as file:
            return file.read()


def _in_space(X: np.ndarray) -> np.ndarray:
    """Return (n, 3) points of (n, d) ones."""
    return np.pad(X, ((0, 0), (0, 3 - X.shape[1])))


def _cell_data(scene: Scene) -> dict[str, Any]:
    """Return what each element has, (b,) arrays by name."""
    pairs, X = all_pairs(scene.groups), scene.coordinates
    kinds = np.array([group.kind == "strut" for group in scene.groups])
    l = elements.lengths((X[pairs[:, 1]] - X[pairs[:, 0]]).T)
    told = {"group": scene.owners, "strut": kinds[scene.owners].astype(int), "length": l}
    told["EA"] = scene.axial_stiffness
    if scene.is_geometry:
        return told
    s = from_scene(scene)
    least, stretch = elements.least_extensions(s.tension_only), l - s.rest_lengths
    t = elements.forces(s.stiffness, elements.extensions(stretch, least))
    return told | {
        "rest_length": s.rest_lengths,
        "force": t,
        "force_density": elements.force_densities(t, l),
        "slack": (~elements.taut(stretch, least)).astype(int),
    }
