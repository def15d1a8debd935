"""T-bars: struts that a crosspiece and four cables brace in the middle."""

from math import cos, radians
from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members
from cgff_cli.scene.families.columns import Angle, Length, across, ends, pressed
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new t-bar",
    "cgff new t-bar --iterations 5 --angle 10 --load 50 --noise 0.1 -o column.yaml",
)


def equilibrium(
    *,
    iterations: Annotated[int, Rule("how often struts along it are braced", least=1, most=16)] = 2,
    length: Length = 10.0,
    angle: Angle = 45.0,
    load: Annotated[float, Rule("load that presses its ends together", least=0)] = 10.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Plane T-bar: a strut braced in its middle by a crosspiece and four cables, again and again.

    Cables of one force density s, whose shadows on the strut are a long, press on it by 2 s a; crosspieces
    have -2 s. Each level's thrust adds to the next: load + 2 s length (1 - 2^-q) at last, in 2^q struts,
    beside 2 (2^q - 1) crosspieces and 4 (2^q - 1) cables, with a self-stress for each brace. Angles fall
    evenly with the level, which keeps braces apart. A brace of angle a, of stiff struts under law hooke,
    gives way at the thrust 2 EA sin(a)^2 cos(a). The form is that of Skelton and de Oliveira, "Tensegrity
    Systems" (2009); its forces by statics.
    """
    X, struts = ends(length)
    s = prestress * 2.0 * cos(radians(angle)) / length
    cables, crosses = [], []
    for level in range(iterations):
        middle, side = across(X, struts, angle * (1.0 - level / iterations))
        count, (start, end) = len(struts), struts.T
        hub = len(X) + np.arange(count)
        left, right = hub + count, hub + 2 * count
        X = np.concatenate([X, middle, middle + side, middle - side])
        pairs = np.stack([start, left, left, end, start, right, right, end], axis=1)
        cables.append(members(f"cables_{level + 1}", "cable", pairs, s))
        crosses.append(np.stack([hub, left, hub, right], axis=1).reshape(-1, 2))
        struts = np.stack([start, hub, hub, end], axis=1).reshape(-1, 2)
    thrust = load + 2.0 * s * length * (1.0 - 0.5**iterations)
    groups = [
        *cables,
        members("crosspieces", "strut", np.concatenate(crosses), -2.0 * s),
        members("struts", "strut", struts, -thrust / length * 2.0**iterations),
    ]
    answer = f"by statics, one force density in all cables, thrust {thrust:.10g} in the struts"
    return pressed(f"T-bar of {iterations} iterations", X, groups, load, answer)
