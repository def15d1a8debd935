"""A scene once more, its start the shape that was found."""

from cgff_cli.result import Result
from cgff_cli.scene.write import to_yaml


def scene_text(result: Result) -> str:
    """Return the scene file: rest lengths as they were, loads and cases as the scene has them."""
    source = result.source.whole or result.source
    case = f" in case {result.source.case}" if result.source.case else ""
    said = f"Start coordinates: what cgff solve made of {result.source.path}{case}: {result.message}."
    return to_yaml(source.with_coordinates(result.coordinates), said)
