"""VTU and DXF, opened again by programs that are not ours."""

import io
import json
from importlib.util import find_spec

import numpy as np
import pytest

import cgff_cli
from cgff_cli.errors import OptionError

BRACKET = cgff_cli.shipped("bracket")
PRISM = cgff_cli.shipped("prism")


@pytest.fixture
def solved(tmp_path):
    """Return the result of the prism, and the path of its JSON."""
    from cgff_cli.report import json_out

    result = cgff_cli.solve(cgff_cli.load(PRISM))
    path = tmp_path / "prism.json"
    path.write_text("".join(json_out.pretty(json_out.result_fields(result))))
    return result, path


def opened(tmp_path, converted):
    import meshio

    (tmp_path / "own.vtu").write_bytes(converted.written("vtu"))
    return meshio.read(tmp_path / "own.vtu")


@pytest.mark.needs_meshio
def test_a_result_as_vtu_holds_its_forces_lengths_and_how_far_nodes_moved(solved, tmp_path):
    result, path = solved
    mesh = opened(tmp_path, cgff_cli.convert(str(path)))
    (block,) = mesh.cells
    assert (block.type, len(block.data)) == ("line", 12)
    assert np.array_equal(mesh.points, result.coordinates)
    assert np.array_equal(mesh.point_data["displacement"], result.coordinates - result.source.coordinates)
    data = {name: own[0] for name, own in mesh.cell_data.items()}
    assert data["force"] == pytest.approx(result.forces, rel=1e-12)
    assert data["length"] == pytest.approx(result.lengths, rel=1e-14)
    assert data["force_density"] == pytest.approx(result.force_densities, rel=1e-12)
    assert data["group"].tolist() == [0] * 6 + [1] * 3 + [2] * 3
    assert data["strut"].tolist() == [0] * 9 + [1] * 3
    assert data["slack"].tolist() == [0] * 12


@pytest.mark.needs_meshio
def test_a_plane_scene_lies_at_z_0_and_a_geometry_has_no_forces(tmp_path):
    mesh = opened(tmp_path, cgff_cli.convert(BRACKET))
    assert mesh.points[:, 2].tolist() == [0.0] * 3
    assert "displacement" not in mesh.point_data
    (tmp_path / "net.obj").write_text("v 0 0 0\nv 3 4 0\nl 1 2\n")
    geometry = cgff_cli.convert(str(tmp_path / "net.obj"), law="paper", EA=2.0, kind="strut")
    data = opened(tmp_path, geometry).cell_data
    assert {name: own[0].tolist() for name, own in data.items()} == {
        "group": [0],
        "strut": [1],
        "length": [5.0],
        "EA": [2.0],
    }


@pytest.mark.needs_meshio
def test_vtk_itself_reads_it(solved, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    opened(tmp_path, cgff_cli.convert(str(solved[1])))
    grid = pyvista.read(tmp_path / "own.vtu")
    assert (grid.n_points, grid.n_cells) == (6, 12)
    assert grid.cell_data["force"] == pytest.approx(solved[0].forces)


def test_displacements_are_left_out_where_the_scene_of_a_result_is_gone_or_another(solved, tmp_path):
    _, path = solved
    value = json.loads(path.read_text())
    for other, said in ((str(tmp_path / "gone.yaml"), "cannot be read"), (BRACKET, "has other nodes now")):
        value["scene"]["path"] = other
        path.write_text(json.dumps(value))
        found = cgff_cli.convert(str(path))
        assert found.start[0] is None
        assert found.not_kept("vtu")[-1] == f"displacements: the scene {other} {said}"


@pytest.mark.needs_ezdxf
def test_a_scene_as_dxf_has_a_layer_each_group_and_a_line_each_element():
    import ezdxf

    found = cgff_cli.convert(PRISM)
    document = ezdxf.read(io.StringIO(found.written("dxf")))
    assert document.audit().errors == []
    lines = list(document.modelspace())
    layers = [line.dxf.layer for line in lines]
    assert layers == ["triangles"] * 6 + ["verticals"] * 3 + ["struts"] * 3
    assert set(layers) <= {layer.dxf.name for layer in document.layers}
    X = found.scene.coordinates
    a, b = found.scene.groups[0].pairs[0]
    assert (tuple(lines[0].dxf.start), tuple(lines[0].dxf.end)) == (tuple(X[a]), tuple(X[b]))
    assert found.written("dxf") == cgff_cli.convert(PRISM).written("dxf")


@pytest.mark.needs_ezdxf
def test_layers_keep_apart_names_that_differ_in_case_or_in_what_dxf_forbids(tmp_path):
    import ezdxf

    groups = ["a/b", "a:b", "A_B", "0", "Defpoints", "name ✓"]
    elements = {
        name: {"kind": "cable", "EA": 1.0, "rest_length": 1.0, "pairs": [[f"n{i}", f"n{i + 1}"]]}
        for i, name in enumerate(groups)
    }
    nodes = {f"n{i}": [i, 0] for i in range(len(groups) + 1)}
    scene = cgff_cli.from_dict({"law": "paper", "nodes": nodes, "elements": elements})
    (tmp_path / "own.yaml").write_text(cgff_cli.to_yaml(scene))
    text = cgff_cli.convert(str(tmp_path / "own.yaml")).written("dxf")
    layers = [line.dxf.layer for line in ezdxf.read(io.StringIO(text)).modelspace()]
    assert len({layer.lower() for layer in layers}) == len(groups)


def test_an_extra_that_is_missing_is_told_with_the_command_that_brings_it(monkeypatch):
    import importlib.util

    missing = {"meshio", "ezdxf"}
    monkeypatch.setattr(
        importlib.util, "find_spec", lambda name: None if name in missing else find_spec(name)
    )
    for module in ("vtu", "dxf"):
        monkeypatch.setattr(f"cgff_cli.formats.{module}.find_spec", importlib.util.find_spec)
    for form, extra in (("vtu", "mesh"), ("dxf", "dxf")):
        with pytest.raises(OptionError, match=rf"is not installed: pip install 'cgff-cli\[{extra}\]'$"):
            cgff_cli.convert(PRISM).written(form)


def test_of_what_a_format_cannot_hold_only_what_there_is_is_told(tmp_path):
    assert cgff_cli.convert(PRISM).not_kept("scene") == ()
    assert cgff_cli.convert(PRISM).not_kept("dxf") == (
        "names of nodes, EA and rest lengths: DXF holds lines and layers",
    )
    assert cgff_cli.convert(BRACKET).not_kept("vtu") == (
        "names of nodes, names of groups, the law, supports and loads: VTU holds points, lines and numbers",
    )
    (tmp_path / "net.obj").write_text("v 0 0 0\nv 3 4 0\nl 1 2\n")
    geometry = cgff_cli.convert(str(tmp_path / "net.obj"), law="paper", EA=2.0, kind="strut")
    assert geometry.not_kept("obj") == ("names of nodes, kinds and EA: OBJ holds points and lines",)
