"""Stress from the boundary of a rectangular box: what a laboratory would measure.

In equilibrium V sigma = sum x (x) f over all forces on the boundary (divergence theorem; literature:
Love-Weber). Coordinates are taken from the middle of the box, so that the result does not depend on
the origin even when the forces of opposite walls differ. Compression positive; (dim, dim).
"""

from __future__ import annotations

import numpy as np

from postproc.geometry import box_bounds, periodic_axes, vector, volume_between
from postproc.macro.contact_ends import outer, recorded_contacts
from postproc.snapshot import MissingColumn, Snapshot


def stress_from_wall_contacts(snapshot: Snapshot) -> np.ndarray:
    """sigma = (1/V) sum_{c at walls} x^c f^c, f the force on the wall, x the contact point.

    Equals `stress` of the whole box exactly (all components, walls with or without friction) when
    the contact forces on every particle sum to zero; the difference is (1/V) sum_p x^p F^p with
    the net forces F^p.
    """
    _closed_box(snapshot)
    contacts = recorded_contacts(snapshot)
    at_walls = contacts["j"] < 0
    x = vector(contacts, "p", snapshot)[at_walls] - _middle(snapshot)
    f = -vector(contacts, "f", snapshot)[at_walls]
    return outer(x, f).sum(axis=0) / volume_between(box_bounds(snapshot), snapshot)


def stress_from_walls(snapshot: Snapshot) -> np.ndarray:
    """sigma_ab = (1/V) sum_{w normal to a} x_a^w f_b^w, f the force of the particles on the wall.

    Row a is the mean traction on the two faces normal to a: force over face area, averaged over
    both faces. Needs no contacts. The diagonal equals that of the mean stress in equilibrium with
    frictionless walls; with wall friction, and for shear components, the walls' totals do not say
    where a force acts, and `stress_from_wall_contacts` is the exact form.
    MissingColumn unless every wall is normal to an axis and every face has one.
    """
    _closed_box(snapshot)
    if snapshot.walls is None:
        raise MissingColumn("walls were not recorded")
    x, n, f = (vector(snapshot.walls, letter, snapshot) for letter in "pnf")
    _walls_on_every_face(n, snapshot)
    normal_to = np.abs(n) == 1.0
    arm = np.where(normal_to, x - _middle(snapshot), 0.0)
    return outer(arm, f).sum(axis=0) / volume_between(box_bounds(snapshot), snapshot)


def _walls_on_every_face(n: np.ndarray, snapshot: Snapshot) -> None:
    """Normals (W, dim) must be those of the faces; a wall that is left out would be a stress of 0."""
    along = (np.abs(n) == 1.0).any(axis=1)
    if not along.all():
        oblique = snapshot.walls["id"][np.argmin(along)]
        raise MissingColumn(f"wall {oblique:.0f} is not normal to an axis")
    for axis, name in enumerate(snapshot.axes):
        for sign, side in ((1.0, "lower"), (-1.0, "upper")):
            if not (n[:, axis] == sign).any():
                raise MissingColumn(f"there is no wall at the {side} end of {name}")


def _middle(snapshot: Snapshot) -> np.ndarray:
    return box_bounds(snapshot).mean(axis=1)


def _closed_box(snapshot: Snapshot) -> None:
    box_bounds(snapshot)
    if periodic_axes(snapshot).any():
        raise MissingColumn("a periodic box has no wall on every side")
