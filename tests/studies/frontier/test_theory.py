"""From systems to springs: lattices with closed forms, walls, laws about their state at rest."""

import math

import numpy as np
import pytest

from harness.scene.contact import ConstantRolling, Contact, LinearNormal
from harness.studies.frontier import laws, packings
from harness.studies.frontier.formula import formula_limit
from harness.studies.frontier.laws import LawCase
from harness.studies.frontier.packings import resting_system
from harness.studies.frontier.study import unit_of_time
from harness.studies.frontier.theory import linear_packing, theory_of, touching


@pytest.fixture(scope="session")
def rest(tmp_path_factory):
    """rest(packing, law): a system at rest; packings are made once."""
    cache = tmp_path_factory.mktemp("packings")
    made = {}

    def system(packing, law):
        packed = made.setdefault(packing.name, None) or packing.make(cache)
        made[packing.name] = packed
        return resting_system(packing, packed, law)

    return system


@pytest.mark.parametrize(
    ("packing", "limit"), [(packings.SQUARE, 1.0), (packings.TRIANGULAR, 0.8165), (packings.FCC, 0.7071)]
)
def test_lattices_in_units_of_time(rest, packing, limit):
    """Without friction, up to the pre-stress of one part in two thousand."""
    system = rest(packing, laws.ELASTIC)
    assert theory_of(system, "lammps").exact / unit_of_time(system) == pytest.approx(limit, rel=1e-3)


def test_every_particle_of_a_lattice_has_its_neighbours(rest):
    for packing, neighbours in ((packings.SQUARE, 4), (packings.TRIANGULAR, 6), (packings.FCC, 12)):
        system = rest(packing, laws.ELASTIC)
        contacts, overlap = touching(system)
        assert len(contacts.i) == neighbours * len(system.particles) / 2
        assert overlap == pytest.approx(laws.OVERLAP * laws.RADIUS, rel=1e-6)


def test_forces_of_every_packing_balance(rest):
    for packing in (*packings.WHOLE,):
        system = rest(packing, laws.ELASTIC)
        contacts, overlap = touching(system)
        force = laws.STIFFNESS * overlap[:, None] * contacts.normal
        net = np.zeros_like(system.particles.x)
        np.add.at(net, contacts.i, force)
        pairs = contacts.j >= 0
        np.add.at(net, contacts.j[pairs], -force[pairs])
        assert np.abs(net).max() < 1e-8 * laws.STIFFNESS * laws.OVERLAP * laws.RADIUS * 1e2


def test_hertz_contacts_are_as_stiff_as_the_linear_ones_of_a_lattice(rest):
    """The modulus is chosen so."""
    hertz, linear = (theory_of(rest(packings.TRIANGULAR, law), "lammps").exact for law in (laws.HERTZ, laws.ELASTIC))
    assert hertz == pytest.approx(linear, rel=1e-3)


def test_the_formula_of_scenes_is_never_larger(rest):
    for packing in packings.WHOLE:
        for law in (*laws.QUICK, laws.VISCOUS, laws.ROLLING):
            system = rest(packing, law)
            assert formula_limit(system) <= theory_of(system, "lammps").exact * (1 + 1e-6), (packing.name, law.name)


def test_late_springs_without_dashpots_have_no_stable_step():
    """On a dozen particles: all eigenvalues are computed many times."""
    packed = packings.lattice(np.array([[0.0, 0.0], [0.5, math.sqrt(0.75)]]), np.array([1.0, math.sqrt(3.0)]), (3, 2))
    undamped, damped = (resting_system(packings.TRIANGULAR, packed, law) for law in (laws.FRICTION, laws.WEAK))
    assert theory_of(undamped, "kernel:talk").exact == 0.0
    weak = theory_of(damped, "kernel:talk").exact
    sliding = laws.WEAK.contact.sliding
    assert weak == pytest.approx(sliding.shear_damping / sliding.shear_stiffness, rel=0.02)


def test_what_has_no_theory_says_why(rest):
    jumps = Contact(normal=laws.linear(), rolling=ConstantRolling(rolling_friction=0.1))
    found = theory_of(rest(packings.SQUARE, LawCase(name="jumps", contact=jumps)), "lammps")
    assert found.exact is None
    assert "jumps" in found.note
    assert found.guess > 0
    other = theory_of(rest(packings.SQUARE, laws.FRICTION), "kernel:corrected")
    assert other.exact is None
    assert "scheme" in other.note


def test_damping_ratio_is_that_of_a_pair():
    law = laws.linear(damping=1.0)
    assert isinstance(law, LinearNormal)
    assert law.normal_damping == pytest.approx(2 * math.sqrt(law.normal_stiffness * laws.MASS / 2))


def test_walls_are_fixed_partners(rest):
    system = rest(packings.RANDOM, laws.FRICTION)
    contacts, _ = touching(system)
    at_walls = contacts.j < 0
    assert at_walls.sum() >= 4
    assert np.isinf(contacts.distance[at_walls]).all()
    assert set(map(tuple, contacts.normal[at_walls])) == {(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)}
    assert linear_packing(system).largest_step() > 0
