"""Averages of the lattice box, whose answers are exact."""

from dataclasses import replace

import numpy as np
import pytest

from harness.scene.contact import HystereticNormal, SpringRolling, ViscousSliding
from harness.studies.compare.states import OF_THE_OVERLAP, SHOWN, frame_averages, state_curves


def test_stresses_and_strain_are_exact(box):
    states = state_curves(box.trajectory(), box.system)
    eps = states.strain
    assert eps == pytest.approx(box.strain(np.linspace(0, 0.08, 21)), abs=1e-15)
    for kind in ("contacts", "walls"):
        assert states.values[f"sigma_xx from {kind}"] == pytest.approx(np.full(21, 100.0), rel=1e-12)
        assert states.values[f"sigma_zz from {kind}"] == pytest.approx(100 * (1 + 20 * eps), rel=1e-12)
    assert states.values["sigma_xz from contacts"] == pytest.approx(np.zeros(21), abs=1e-12)
    area = 9 * np.pi * 1e-6
    assert states.values["volume fraction"] == pytest.approx(area / (6e-3**2 * (1 + eps / 2) * (1 - eps)), rel=1e-12)
    assert states.values["kinetic energy"] == pytest.approx(np.zeros(21))


def test_a_box_without_an_inner_part_leaves_its_averages_out(box):
    """The border of two mean diameters on each side is wider than this box of three."""
    states = state_curves(box.trajectory(), box.system)
    assert not any(SHOWN[name][0] == "inner" for name in states.values)
    assert "coordination number, inner" not in states.values


def test_frames_without_contacts_give_what_needs_none(box):
    trajectory = box.trajectory()
    bare = replace(trajectory, frames=tuple(replace(f, contacts=None) for f in trajectory))
    assert set(state_curves(bare, box.system).values) == {
        "volume fraction", "kinetic energy", "rotational energy", "sigma_xx from walls", "sigma_zz from walls",
    }


def test_without_friction_there_is_no_spring_and_no_spin_to_average(box):
    frame, sliding = box.trajectory().frames[3], box.system
    rolling = SpringRolling(rolling_friction=0.1, rolling_stiffness=1e4, rolling_damping=0.0)
    viscous = ViscousSliding(shear_friction=0.5, shear_damping=0.1)

    def of_friction(**laws):
        found = frame_averages(frame, sliding.with_(**laws))
        return {"rotational energy", "elastic energy, tangential"} & set(found)

    assert of_friction() == {"rotational energy", "elastic energy, tangential"}
    assert of_friction(sliding=None) == set()
    assert of_friction(sliding=None, rolling=rolling) == of_friction(sliding=viscous) == {"rotational energy"}


def test_energy_that_a_law_keeps_in_its_memory_is_left_out_with_its_reason(box):
    law = HystereticNormal(
        loading_stiffness=5e4, unloading_stiffness=1e5, adhesion_stiffness=0.0, normal_damping=0.1
    )
    linear, hysteretic = (state_curves(box.trajectory(), box.system.with_(normal=n)) for n in (box.system.normal, law))
    assert set(linear.values) - set(hysteretic.values) == set(OF_THE_OVERLAP)
    reasons = {hysteretic.absent[q] for q in OF_THE_OVERLAP}
    assert reasons == {'the law "hysteretic" stores what the overlap does not tell'}
    assert set(OF_THE_OVERLAP) & set(linear.absent) == set()


def test_units_are_those_of_the_post_processor(box):
    units = state_curves(box.trajectory(), box.system).units
    assert (units["sigma_zz from walls"], units["kinetic energy"], units["volume fraction"]) == ("N/m", "J", "1")


def test_elastic_energy_is_that_of_the_springs(box):
    frame = box.trajectory().frames[-1]
    found = frame_averages(frame, box.system)
    assert found["elastic energy, normal"] == pytest.approx((1e5 * frame.contacts["overlap"] ** 2 / 2).sum())
    assert found["elastic energy, tangential"] == 0.0
    assert found["kinetic over elastic energy"] == 0.0
    assert found["largest residual force"] == pytest.approx(0.0, abs=1e-12)
