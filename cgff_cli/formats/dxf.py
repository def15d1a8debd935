"""DXF, for CAD programs: a LINE each element, a layer each group; by ezdxf."""

import io
from importlib.util import find_spec

from cgff_cli.errors import OptionError
from cgff_cli.formats.names import distinct
from cgff_cli.scene.scene import Scene

_COLOURS = {"cable": 5, "strut": 1}
"""Of the colour index: blue, red."""


def check_ezdxf() -> None:
    """Raise OptionError unless ezdxf is installed."""
    if find_spec("ezdxf") is None:
        raise OptionError("DXF needs ezdxf, which is not installed: pip install 'cgff-cli[dxf]'")


def dxf_text(scene: Scene) -> str:
    """Return a scene as DXF of release 2010, without units; z is 0 where the scene is plane."""
    check_ezdxf()
    import ezdxf

    was, ezdxf.options.write_fixed_meta_data_for_testing = (
        ezdxf.options.write_fixed_meta_data_for_testing,
        True,  # neither dates nor random names: the same scene gives the same bytes
    )
    try:
        document = ezdxf.new("R2010", units=0)
        space = document.modelspace()
        names = distinct((group.name for group in scene.groups), r"[^\w.()+ -]")
        points = scene.coordinates.tolist()
        for name, group in zip(names, scene.groups, strict=True):
            layer = name if name not in document.layers else f"{name}_"
            document.layers.add(layer, color=_COLOURS[group.kind])
            for start, end in group.pairs.tolist():
                space.add_line(points[start], points[end], dxfattribs={"layer": layer})
        out = io.StringIO()
        document.write(out)
        return out.getvalue()
    finally:
        ezdxf.options.write_fixed_meta_data_for_testing = was
