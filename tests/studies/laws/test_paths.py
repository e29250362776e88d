"""The paths: what closed forms lean on must hold to the last bit, and no contact may meet a stranger."""

import numpy as np
import pytest

from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.closed_forms import contact_of
from harness.studies.laws.frames import frames
from harness.studies.laws.motions import DT, EQUAL_RADII, ROWS, SEQUENCES, UNEQUAL, UNIT, motions
from harness.studies.laws.rounding import distance, settled
from reference.kernel.conventions import CONVENTIONS

KINDS = [(partner, dimension) for partner in ("pair", "plane") for dimension in (2, 3)]


def overlaps(motion, grains) -> np.ndarray:
    """From places alone, as a code does it."""
    if motion.x.shape[1] == 1:
        return grains.radii[0] - motion.x[:, 0, 0]
    return sum(grains.radii) - np.linalg.norm(motion.x[:, 0] - motion.x[:, 1], axis=1)


@pytest.mark.parametrize("grains", [UNEQUAL, EQUAL_RADII], ids=["unequal", "equal radii"])
@pytest.mark.parametrize(("partner", "dimension"), KINDS)
def test_motions_start_and_end_apart_and_touch_twice(partner, dimension, grains):
    for motion in motions(partner, dimension, grains):
        depth = overlaps(motion, grains)
        touching = depth > 0.0
        assert depth[touching].min() > (0.49 if motion.course else 1.0) * UNIT
        assert not touching[0]
        assert not touching[-1]
        assert (np.diff(touching.astype(int)) == 1).sum() == 2, motion.name


@pytest.mark.parametrize(("partner", "dimension"), KINDS)
def test_legs_carry_no_rounding(partner, dimension):
    for motion in motions(partner, dimension, UNEQUAL):
        if motion.course is None:
            continue
        assert np.array_equal(overlaps(motion, UNEQUAL), motion.course.overlap), motion.name
        assert np.array_equal(np.diff(motion.x, axis=0) / DT, motion.v[1:]), motion.name
        assert (motion.course.overlap != 0.0).all()


@pytest.mark.parametrize(("partner", "dimension"), KINDS)
def test_mixed_has_half_step_velocities_and_uses_all_components(partner, dimension):
    mixed = motions(partner, dimension, UNEQUAL)[-1]
    assert np.diff(mixed.x, axis=0) / DT == pytest.approx(mixed.v[1:], abs=1e-9)
    used = [np.ptp(mixed.x[..., k]) > 0.0 for k in range(3)], [np.ptp(mixed.spin[..., k]) > 0.0 for k in range(3)]
    assert used == (([True] * 3, [True] * 3) if dimension == 3 else ([True, True, False], [False, False, True]))


@pytest.mark.parametrize("partner", ["pair", "plane"])
def test_shear_slips_rolls_and_twists_one_at_a_time(partner):
    names = {"slip": "shear", "roll": "roll", "twist": "twist"}
    found = {m.name: m for m in motions(partner, 3, UNEQUAL)}
    for word, name in names.items():
        seen = contact_of(found[name], partner, UNEQUAL, CONVENTIONS["lammps"])
        for other in names:
            asked = getattr(found[name].course, other)[1:]
            assert getattr(seen, other) == pytest.approx(asked, abs=1e-12)
            assert asked.any() == (other == word)


def test_legs_fit_into_the_rows():
    assert max(sum(leg.rows for leg in legs) for legs in SEQUENCES.values()) == ROWS


@pytest.mark.parametrize(("partner", "dimension"), KINDS)
def test_frames_change_nothing_that_a_law_may_see(partner, dimension):
    """Branch, relative velocity and spins, mapped back to the contact's axes."""
    for motion in motions(partner, dimension, UNEQUAL):
        for frame in frames(partner, dimension):
            x, v, spin = frame.embed(motion)
            inverse = np.swapaxes(frame.axes, 1, 2)
            relative = v - np.cross(frame.rotation, x)
            if partner == "pair":
                x, relative = x[:, :1] - x[:, 1:], relative[:, :1] - relative[:, 1:]
                plain_x, plain_v = (a[:, :1] - a[:, 1:] for a in (motion.x, motion.v))
                assert np.einsum("kab,kpb->kpa", inverse, x) == pytest.approx(plain_x, abs=1e-18)
            else:
                plain_v = motion.v
            assert np.einsum("kab,kpb->kpa", inverse, relative) == pytest.approx(plain_v, abs=1e-13)
            own = frame.handedness * np.einsum("kab,kpb->kpa", inverse, spin - frame.rotation)
            assert own == pytest.approx(motion.spin, abs=1e-9)


@pytest.mark.parametrize(("partner", "dimension"), KINDS)
def test_places_are_rounded_so_that_overlaps_are_not(partner, dimension):
    """Of the coordinates that engines are given: off by 2e-19 m (rms), where plain rounding would make it 7e-19."""
    made = arrangement(partner, dimension)
    normals = {w.name: np.array([*w.normal, 0.0])[:3] for w in made.walls}
    off = []
    for track in made.tracks:  # in extended precision
        x = np.zeros((ROWS + 1, len(track.bodies), 3), np.longdouble)
        x[..., :dimension] = made.path.x[:, list(track.bodies)]
        if partner == "pair":
            off.append(distance(x[:, 0], x[:, 1]) - distance(track.motion.x[:, 0], track.motion.x[:, 1]))
        else:
            normal = normals["tilted" if track.frame.name == "tilted" else "level"]
            off.append((x[:, 0] * normal).sum(axis=1) - track.motion.x[:, 0, 0])
    rounded = np.square([d for d in off if d.any()])
    assert np.sqrt(rounded.mean()) < (2e-19 if partner == "pair" else 8e-20)
    assert rounded.mean(axis=1).max() < (4e-19) ** 2


def test_a_place_moves_by_its_last_digits_only():
    rng = np.random.default_rng(2)
    x, normal = rng.uniform(-1e-2, 1e-2, (500, 3)), rng.normal(size=(500, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    normal[:100, 2], x[:100, 2] = 0.0, 0.0
    excess = rng.uniform(-1e-18, 1e-18, 500).astype(np.longdouble)
    moved = settled(x, normal, excess)
    assert (np.abs(moved - x) <= 2 * np.spacing(np.abs(x))).all()
    assert not moved[:100, 2].any()
    left = excess + ((moved.astype(np.longdouble) - x) * normal).sum(axis=1)
    assert np.abs(left).mean() < 0.1 * np.abs(excess).mean()
    assert np.array_equal(settled(x, normal, 0.0 * excess), x)


def test_frames_map_forces_and_torques_back():
    rng = np.random.default_rng(1)
    for frame in frames("pair", 3):
        force, torque = rng.normal(size=(2, ROWS, 2, 3))
        turned = np.einsum("kab,kpb->kpa", frame.axes[1:], force)
        spun = frame.handedness * np.einsum("kab,kpb->kpa", frame.axes[1:], torque)
        back = frame.back(turned, spun)
        assert back[0] == pytest.approx(force, abs=1e-14)
        assert back[1] == pytest.approx(torque, abs=1e-14)


def test_mirror_and_only_the_mirror_is_left_handed():
    for partner, dimension in KINDS:
        assert [f.name for f in frames(partner, dimension) if f.handedness < 0] == ["mirrored"]


@pytest.mark.parametrize(("partner", "dimension"), KINDS)
def test_contacts_never_meet_strangers(partner, dimension):
    from scipy.spatial import cKDTree

    made = arrangement(partner, dimension)
    owner = {row: k for k, track in enumerate(made.tracks) for row in track.bodies}
    radius, widest = made.particles.radius, 2 * made.particles.radius.max()
    assert sorted(owner) == list(range(len(radius)))
    for x in made.path.x[::6]:
        near = cKDTree(x).query_pairs(widest)
        assert all(owner[i] == owner[j] for i, j in near if np.linalg.norm(x[i] - x[j]) < 1.2 * (radius[i] + radius[j]))


@pytest.mark.parametrize("dimension", [2, 3])
def test_bodies_touch_the_plane_of_their_frame_and_no_other(dimension):
    made = arrangement("plane", dimension)
    for wall in made.walls:
        gap = ((made.path.x - wall.point) @ np.array(wall.normal) - made.particles.radius).min(axis=0)
        own = [t.bodies[0] for t in made.tracks if (t.frame.name == "tilted") == (wall.name == "tilted")]
        others = np.setdiff1d(np.arange(len(gap)), own)
        assert (gap[own] < 0.0).all()
        assert (gap[others] > 0.5 * made.particles.radius[0]).all()


def test_every_contact_has_one_reduced_mass_and_radius():
    for grains in (UNEQUAL, EQUAL_RADII):
        made = arrangement("pair", 3, grains)
        i, j = (np.array([t.bodies[k] for t in made.tracks]) for k in (0, 1))
        for quantity in (made.particles.mass, made.particles.radius):
            assert len(np.unique(quantity[i] * quantity[j] / (quantity[i] + quantity[j]))) == 1
    relabelled = [t for t in made.tracks if t.frame.name == "relabelled"]
    assert all(t.bodies[0] > t.bodies[1] for t in relabelled)
    assert len(relabelled) == 6
