"""Mindlin's springs make energy unless something takes it; nothing else is warned of."""

import pytest

from harness.scene.energy import energy_warnings


@pytest.fixture
def warned(scenes):
    """warned(restitution, drag): what is said of two Hertz-Mindlin discs."""

    def of(restitution, drag=None, sliding="mindlin"):
        numbers = {"mindlin": {}, "spring": {"shear_stiffness": 1e3, "shear_damping": 0.0}}[sliding]
        changes = {
            "contact.normal": {"law": "hertz", "youngs_modulus": 1e7, "poisson_ratio": 0.3, "restitution": restitution,
                               "attraction": "allowed", "impact_speed": 0.1},
            "contact.sliding": {"law": sliding, "shear_friction": 0.5, **numbers},
            "outputs.samples": 1, "outputs.frames": 1,
        } | ({} if drag is None else {"background": {"translational_drag": drag}})
        return [what for what, _ in energy_warnings(scenes.load(scenes.free, changes))]

    return of


def test_mindlin_without_a_dashpot(warned):
    assert warned(1.0) == ["Mindlin springs without a dashpot"]


@pytest.mark.parametrize("given", [(0.99,), (1.0, 0.01), (1.0, None, "spring")])
def test_what_takes_energy_or_has_a_potential(warned, given):
    assert warned(*given) == []
