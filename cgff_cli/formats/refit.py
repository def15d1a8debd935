"""A result's shape and forces in elements of another law and EA: ropes for a form of force densities."""

from dataclasses import replace

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.formats.draft import Asked
from cgff_cli.scene.laws import rest_lengths_for
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import from_scene


def refitted(scene: Scene, asked: Asked) -> Scene:
    """Return a scene in which other elements have the forces that a result's have, as their pretension.

    scene : out of a result, at the shape found     asked : law and EA; what is not given stays

    Raises OptionError where no rest length gives an element its force.
    """
    law = asked.law or scene.law
    structure = from_scene(scene)
    V = structure.coordinates[structure.end] - structure.coordinates[structure.start]
    l = np.linalg.norm(V, axis=1)
    t = structure.stiffness * (l - structure.rest_lengths)
    t = np.where(structure.tension_only, np.maximum(t, 0.0), t)
    ends = np.cumsum([len(group.EA) for group in scene.groups])[:-1]
    groups = []
    for group, own_l, own_t in zip(scene.groups, np.split(l, ends), np.split(t, ends), strict=True):
        given = asked.stiffness_of(group.kind)
        EA = group.EA if given is None else np.full(len(group.EA), given)
        rest = rest_lengths_for(law, own_l, own_t, EA)
        if np.isnan(rest).any():
            row = int(np.isnan(rest).argmax())
            raise OptionError(
                f"no rest length above 0 gives an element of {group.name!r} its force, {own_t[row]:g}, "
                f"at EA {EA[row]:g}: give a larger --EA"
            )
        groups.append(replace(group, EA=EA, rest_length=rest, pretension=own_t))
    return replace(scene, law=law, groups=tuple(groups))
