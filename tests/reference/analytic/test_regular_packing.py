"""Strengths against limit analysis: the largest stress ratio that forces within Coulomb's cone can carry."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from reference.analytic.regular_packing import LayeredPacking, face_centred_cubic, hexagonal


def bonds(dimension, height, width, with_layer):
    """Unit normals of one cell's bonds to the layer above and, if asked, within the layer, at rest length 1."""
    if dimension == 2:
        return [(height, width), (height, -width)] + ([(0.0, 1.0)] if with_layer else [])
    across = [(height, width, 0), (height, -width, 0), (height, 0, width), (height, 0, -width)]
    return across + ([(0, math.sqrt(0.5), math.sqrt(0.5)), (0, math.sqrt(0.5), -math.sqrt(0.5))] if with_layer else [])


def tangents(normal):
    """Unit tangents (D - 1, D): in the plane of the axis first."""
    n = np.array(normal, dtype=float)
    axis = np.eye(len(n))[0] if abs(n[0]) > 1e-9 else np.eye(len(n))[-1]
    first = axis - n * (n @ axis)
    if np.linalg.norm(first) < 1e-9:
        first = np.eye(len(n))[1]
    first = first / np.linalg.norm(first)
    return [first] if len(n) == 2 else [first, np.cross(n, first)]


def strongest(normals, friction):
    """Maximise s1 at s2 = s3 = 1 and no shear stress, by forces (N, T...) with N >= 0 and |T| <= mu N for each T.

    The cone of 3D is taken as its circumscribed square: an upper bound, which the in-plane friction attains.
    """
    dimension = len(normals[0])
    stress, limits = [], []
    width = dimension  # unknowns a bond
    for number, normal in enumerate(normals):
        for t in range(dimension - 1):
            for sign in (1, -1):
                row = np.zeros(width * len(normals))
                row[width * number], row[width * number + 1 + t] = -friction, sign
                limits.append(row)
        stress += [np.outer(f, normal).ravel() for f in [np.array(normal), *tangents(normal)]]
    stress = np.array(stress).T
    fixed = [dimension * a + b for a in range(dimension) for b in range(dimension) if (a, b) != (0, 0)]
    target = np.eye(dimension).ravel()[fixed]
    bounds = ([(0, None)] + [(None, None)] * (width - 1)) * len(normals)
    result = linprog(-stress[0], limits, np.zeros(len(limits)), stress[fixed], target, bounds)
    return math.inf if result.status == 3 else -result.fun


FRICTIONS = [0.0, 0.1, 0.3, 0.5]


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("with_layer", [True, False])
def test_strength_at_start(friction, with_layer):
    """Contacts within the layer may carry force; the strongest state leaves them without."""
    flat = strongest(bonds(2, math.sqrt(0.75), 0.5, with_layer), friction)
    assert hexagonal(friction=friction).strength == pytest.approx(flat, rel=1e-9)
    cubic = strongest(bonds(3, math.sqrt(0.5), math.sqrt(0.5), with_layer), friction)
    assert face_centred_cubic(friction=friction).strength == pytest.approx(cubic, rel=1e-9)


@pytest.mark.parametrize("friction", FRICTIONS)
@pytest.mark.parametrize("dimension", [2, 3])
def test_softening_path(friction, dimension):
    """Geometry from Pythagoras, ratio from limit analysis, dilatancy from differences of the sizes."""
    packing = hexagonal(friction=friction) if dimension == 2 else face_centred_cubic(friction=friction)
    start = math.cos(packing.contact_angle)
    for part in (0.1, 0.5, 0.9, 1.0):
        strain = part * packing.final_strain

        def sizes(strain):
            height = (1 - strain) * start
            return height, math.sqrt(1 - height**2)

        height, width = sizes(strain)
        carried = strongest(bonds(dimension, height, width, False), friction)
        assert packing.ratio(strain) == pytest.approx(carried, rel=1e-9)
        area = height * width ** (dimension - 1) / (start * math.sin(packing.contact_angle) ** (dimension - 1))
        assert packing.volume_ratio(strain) == pytest.approx(area, rel=1e-12)
        before, after = (np.log(sizes(strain + step)) for step in (-1e-5, 1e-5))
        slope = -(after - before)[1] / (after - before)[0]
        assert packing.dilatancy(strain) == pytest.approx(slope, rel=1e-8)


@pytest.mark.parametrize("friction", FRICTIONS)
def test_work_goes_into_friction(friction):
    """Power of the stresses = friction force times slip d dth, per contact, along the whole path."""
    packing = hexagonal(friction=friction)
    strain = np.linspace(0, packing.final_strain, 20)
    th = packing.angle(strain)
    axial, lateral = packing.ratio(strain) * np.sin(th), np.cos(th)  # forces a contact carries at s3 = 1, d = 1
    power = axial * np.sin(th) - lateral * np.cos(th)
    normal = axial * np.cos(th) + lateral * np.sin(th)
    assert power == pytest.approx(friction * normal, rel=1e-9, abs=1e-12)
    assert np.all(np.diff(packing.ratio(strain)) < 0)


@pytest.mark.parametrize(("friction", "ratio"), [(0, 3.0), (0.1, 3.838), (0.2, 5.120), (0.3, 7.327), (0.5, 28.86)])
def test_hexagonal_table(friction, ratio):
    packing = hexagonal(friction=friction)
    assert packing.strength == pytest.approx(ratio, rel=2e-4)
    assert packing.strength == pytest.approx(
        math.sqrt(3) * (math.sqrt(3) + friction) / (1 - math.sqrt(3) * friction), rel=1e-12
    )


def test_forms_at_45_degrees():
    assert LayeredPacking(contact_angle=math.pi / 4, friction=0.3).strength == pytest.approx(1.3 / 0.7, rel=1e-12)
    assert face_centred_cubic(friction=0.3).strength == pytest.approx(2 * 1.3 / 0.7, rel=1e-12)


@pytest.mark.parametrize(("packing", "critical"), [(hexagonal, 1 / math.sqrt(3)), (face_centred_cubic, 1.0)])
def test_locking(packing, critical):
    loose, locked = packing(friction=0.999 * critical), packing(friction=1.001 * critical)
    assert not loose.locks
    assert loose.strength > 1e3
    assert locked.locks
    assert locked.strength == math.inf
    if packing is hexagonal:
        assert strongest(bonds(2, math.sqrt(0.75), 0.5, False), 1.001 * critical) == math.inf


def test_end_of_the_path():
    """Layers two apart touch: cos(th) = 1/2."""
    assert hexagonal(friction=0.0).final_strain == pytest.approx(1 - 1 / math.sqrt(3), rel=1e-14)
    assert 2 * math.cos(face_centred_cubic(friction=0.0).angle(1 - math.sqrt(0.5))) == pytest.approx(1, rel=1e-14)


def test_impossible_packings():
    with pytest.raises(ValueError, match="contact_angle"):
        LayeredPacking(contact_angle=0.4, friction=0.1)
    with pytest.raises(ValueError, match="contact_angle"):
        LayeredPacking(contact_angle=math.pi / 6, friction=0.1, dimension=3)
    with pytest.raises(ValueError, match="friction"):
        hexagonal(friction=-0.1)
    for strain in (-0.01, 0.5):
        with pytest.raises(ValueError, match="strain"):
            hexagonal(friction=0.1).ratio(strain)
