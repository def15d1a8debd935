"""Every structure of the project out in each format, and in again: nothing that a format holds is changed."""

import io

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.physics import all_pairs
from cgff_cli.scene.tables_out import element_table, node_table
from tests.formats.folder import FILES
from tests.shapes import STRUCTURES

PATHS = sorted(STRUCTURES.glob("*.yaml"))


@pytest.fixture(params=PATHS, ids=lambda path: path.stem)
def path(request):
    return request.param


@pytest.fixture
def scene(path):
    return cgff_cli.load(path)


def ends_of(scene):
    """Return (b, 2, 3) where elements begin and end, z 0 in a plane."""
    X = np.pad(scene.coordinates, ((0, 0), (0, 3 - scene.dimension)))
    return X[all_pairs(scene.groups)]


def columns_of(scene):
    return [(own.name, own.kind, own.pairs.tolist(), own.EA.tolist()) for own in scene.groups]


def test_obj_keeps_places_kinds_and_pairs(path, scene, tmp_path):
    (tmp_path / "own.obj").write_text(cgff_cli.convert(str(path)).written("obj"))
    kinds = {"": "cable"} | {group.name: group.kind for group in scene.groups}
    back = cgff_cli.convert(str(tmp_path / "own.obj"), law=scene.law, EA=1.0, kind=kinds).scene
    assert np.array_equal(ends_of(back), ends_of(scene))
    assert [own[:2] for own in columns_of(back)] == [own[:2] for own in columns_of(scene)]


def test_tables_keep_all_but_supports_loads_and_weight(scene, tmp_path):
    (tmp_path / "edges.csv").write_text("".join(element_table(scene)))
    (tmp_path / "nodes.csv").write_text("".join(node_table(scene)))
    found = cgff_cli.convert(str(tmp_path / "edges.csv"), nodes=str(tmp_path / "nodes.csv"), law=scene.law)
    assert columns_of(found.scene) == columns_of(scene)
    assert np.array_equal(found.scene.coordinates, scene.coordinates)
    for own, was in zip(found.scene.groups, scene.groups, strict=True):
        assert np.array_equal(own.rest_length, was.rest_length, equal_nan=True)


@pytest.mark.needs_meshio
def test_vtu_keeps_places_ea_and_rest_lengths(path, scene, tmp_path):
    import meshio

    (tmp_path / "own.vtu").write_bytes(cgff_cli.convert(str(path)).written("vtu"))
    mesh = meshio.read(tmp_path / "own.vtu")
    assert np.array_equal(mesh.points[mesh.cells[0].data], ends_of(scene))
    assert np.array_equal(mesh.cell_data["EA"][0], scene.axial_stiffness)
    rest = np.concatenate([own.rest_length for own in scene.groups])
    assert ("rest_length" not in mesh.cell_data) == scene.is_geometry
    assert scene.is_geometry or np.array_equal(mesh.cell_data["rest_length"][0], rest)


@pytest.mark.needs_ezdxf
def test_dxf_keeps_places_and_groups(path, scene):
    import ezdxf

    document = ezdxf.read(io.StringIO(cgff_cli.convert(str(path)).written("dxf")))
    lines = list(document.modelspace())
    ends = np.array([[tuple(line.dxf.start), tuple(line.dxf.end)] for line in lines])
    assert np.array_equal(ends, ends_of(scene))
    assert [line.dxf.layer for line in lines] == [scene.groups[k].name for k in scene.owners]


@pytest.mark.parametrize("name", ["3prism", "4prism", "superball", "spine", "xframe"])
def test_what_comes_in_is_written_as_a_scene_that_says_the_same(name):
    given = {} if name == "xframe" else {"strut_EA": 1e4}
    found = cgff_cli.convert(str(FILES / f"{name}.yaml"), **given)
    back = cgff_cli.loads(found.written("scene"))
    assert columns_of(back) == columns_of(found.scene)
    assert np.array_equal(back.coordinates, found.scene.coordinates)
    for own, was in zip(back.groups, found.scene.groups, strict=True):
        assert np.array_equal(own.rest_length, was.rest_length, equal_nan=True)
