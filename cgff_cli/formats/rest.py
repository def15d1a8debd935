"""Rest lengths out of pretensions."""

from cgff_cli.formats.yaml_values import Source
from cgff_cli.scene.findings import Where


def rest_length_of(
    source: Source, where: Where, length: float, pretension: float, stiffness: float
) -> float | None:
    """Return l0 = l - t / k, the length without force under law `paper`, eq. (2).

    Records, and returns None, where pretension leaves none.
    """
    rest = length - pretension / stiffness
    if rest > 0.0 or (pretension == 0.0 and rest == 0.0):
        return rest
    message = (
        f"pretension {pretension:g} over stiffness {stiffness:g} shortens it by {pretension / stiffness:g}, "
        f"and it is {length:g} long: no rest length is left"
    )
    source.findings.add(where, message)
    return None
