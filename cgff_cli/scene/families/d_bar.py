"""D-bars: diamonds of struts that a cable across keeps from flattening."""

from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, members
from cgff_cli.scene.families.columns import Angle, Length, across, ends, pressed
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new d-bar",
    "cgff new d-bar --iterations 4 --angle 20 --load 5 --noise 0.1 -o column.yaml",
)


def equilibrium(
    *,
    iterations: Annotated[int, Rule("how often struts are replaced by diamonds", least=1, most=10)] = 2,
    length: Length = 10.0,
    angle: Angle = 30.0,
    load: Annotated[float, Rule("load that presses its ends together", positive=True)] = 10.0,
) -> Equilibrium:
    """Plane D-bar: a strut replaced by a diamond of struts and a cable across, again and again.

    Where struts lean by a, each carries 1/(2 cos a) of the thrust and is 1/(2 cos a) of the length, and
    the cable tan a of both: after any iterations, at any angles, force densities are load/length in
    cables and the opposite in struts. 4^q struts, (4^q - 1)/3 cables, no self-stress, no mechanism:
    the C4T1 of Skelton, Helton, Adhikari, Pinaud and Chan 2002. The angle is halved
    at each level, which keeps diamonds apart.
    """
    X, struts = ends(length)
    q = load / length
    groups = []
    for level in range(iterations):
        middle, side = across(X, struts, angle / 2.0**level)
        left = len(X) + np.arange(len(struts))
        right = left + len(struts)
        X = np.concatenate([X, middle + side, middle - side])
        groups.append(members(f"cables_{level + 1}", "cable", np.column_stack([left, right]), q))
        start, end = struts.T
        struts = np.stack([start, left, left, end, start, right, right, end], axis=1).reshape(-1, 2)
    groups.append(members("struts", "strut", struts, -q))
    answer = f"by statics, force densities of cables and struts {q:.10g} and {-q:.10g}"
    return pressed(f"D-bar of {iterations} iterations", X, groups, load, answer)
