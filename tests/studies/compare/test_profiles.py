"""Profiles of rings made by hand: exact answers."""

import numpy as np
import pytest

from harness.studies.compare.band import band_of
from harness.studies.compare.profile_quantities import QUANTITIES
from harness.studies.compare.profiles import profile_of, ring_profiles, steady_frames, subject_of


@pytest.fixture
def averaged(ring):
    def make(of=ring, **settings):
        t = of.trajectory(**settings)
        return ring_profiles([subject_of(f, of.scene, of.system) for f in steady_frames(t, of.scene)], of.system)

    return make


def test_a_rigidly_rotating_ring_has_no_rate_of_strain_and_no_eigen_rotation(averaged):
    p = averaged(v_phi=lambda r: 0.7 * r, spin=lambda r: 0 * r + 0.7, noise=0.0).profiles
    for name in ("D_rphi", "eigen_rotation", "v_r"):
        assert np.nanmax(np.abs(p[name].mean)) < 1e-12, name
        assert np.isfinite(p[name].mean).sum() >= 6, name  # one layer alone has no slope
    assert p["spin"].mean == pytest.approx(np.full(8, 0.7), rel=1e-12)
    assert p["v_phi"].mean[[0, -1]] == pytest.approx(0.7 * np.array([0.02325, 0.05125]), rel=0.02)


def test_spins_of_their_own_are_the_eigen_rotation(averaged):
    p = averaged(v_phi=lambda r: 0.7 * r, spin=lambda r: 0 * r + 0.2, noise=0.0).profiles
    assert p["eigen_rotation"].mean[1:-1] == pytest.approx(np.full(6, -0.5), rel=1e-12)


def test_areas_and_contacts_are_all_there(averaged, ring):
    p = averaged(noise=0.0)
    area = np.pi * np.diff(p.edges**2)
    assert p.profiles["volume_fraction"].mean @ area == pytest.approx(240 * np.pi * 4e-6, rel=1e-12)
    assert p.profiles["coordination_number"].mean == pytest.approx(np.full(8, 2.0), rel=1e-12)
    assert p.profiles["fabric_trace"].mean == pytest.approx(2 * p.profiles["volume_fraction"].mean, rel=1e-12)


def test_glued_discs_take_half_of_themselves_from_the_ring_next_to_them(averaged, ring):
    p = averaged(noise=0.0)
    taken = p.glued * np.pi * np.diff(p.edges**2)
    inner, outer = ring.system.rings
    assert taken[1:-1].max() == 0.0
    for cell, glued in ((0, inner), (-1, outer)):
        assert taken[cell] == pytest.approx(len(glued.radius) * np.pi * 1.25e-3**2 / 2, rel=0.05)


def test_viscous_contacts_have_an_elastic_strain_but_no_curvature(averaged):
    p = averaged(noise=0.0)
    assert p.profiles["elastic_strain_isotropic"].mean[3] > 0
    assert "no curvature" in p.absent["torque_stiffness"]


def test_without_contacts_what_needs_them_is_absent_with_the_reason(averaged):
    p = averaged(contacts=False)
    assert "contacts were not recorded" in p.absent["stress_rr"]
    assert {"v_phi", "volume_fraction", "spin"} <= set(p.profiles)
    assert set(p.profiles) | set(p.absent) == {q.name for q in QUANTITIES}


def test_the_error_is_that_of_independent_frames(averaged):
    p = averaged(noise=0.1, v_phi=lambda r: 0 * r + 0.01).profiles["v_phi"]
    assert p.error == pytest.approx(np.full(8, 0.1 * 0.01 / np.sqrt(120)), rel=0.5)
    assert not p.short.any()


def test_a_slow_series_is_short():
    drift = np.linspace(0.0, 1.0, 100)[:, None] * np.ones(5)
    p = profile_of(drift + 1e-3 * np.random.default_rng(1).normal(size=(100, 5)), "1")
    assert p.short.all()
    assert p.needed > 100


def test_an_exponential_profile_is_a_band_of_its_width(averaged, ring):
    band = band_of(averaged(), ring.scene, ring.system)
    assert band.why == ""
    assert band.width == pytest.approx(6e-3 / 4e-3, rel=0.1)
