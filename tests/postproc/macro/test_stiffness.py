"""The stiffness tensor of regular lattices in closed form, and that it is the derivative of the stress."""

import numpy as np
import pytest

from postproc.averaging.registry import make_cells
from postproc.macro.contact_ends import contact_ends
from postproc.macro.stiffness import (
    contact_bulk_modulus,
    contact_shear_modulus,
    normal_stiffness,
    stiffness_anisotropy,
    tangential_stiffness,
)
from postproc.macro.stress import stress
from postproc.snapshot import MissingColumn

KN, KT = 1e5, 3e4

# per unit thickness in 2D; times k_n, k_t
CLOSED = {
    "triangular": {"xxxx": (3, 1), "yyyy": (3, 1), "xxyy": (1, -1), "xyxy": (1, 1), "xxxy": (0, 0), "yyxy": (0, 0)},
    "square": {"xxxx": (1, 0), "yyyy": (1, 0), "xxyy": (0, 0), "xyxy": (0, 0.5), "xxxy": (0, 0), "yyxy": (0, 0)},
}
SCALE = {"triangular": np.sqrt(3) / 4, "square": 1.0}
VOIGT = ("xx", "yy", "xy")


@pytest.mark.parametrize("kind", CLOSED)
@pytest.mark.parametrize("overlap", [1e-3, 0.1])
def test_closed_form(states, measure, kind, overlap):
    """sqrt(3)/4 (3 k_n + k_t), ...: the factor of the definition; the bonds' length drops out in 2D."""
    C = measure(states.lattice(kind, overlap), "stiffness", kn=KN, kt=KT)[0]
    for name, (n, t) in CLOSED[kind].items():
        found = C[VOIGT.index(name[:2]), VOIGT.index(name[2:])]
        assert found == pytest.approx(SCALE[kind] * (n * KN + t * KT), rel=1e-12, abs=1e-12 * KN), name
    np.testing.assert_allclose(C, C.T, rtol=1e-12, atol=1e-12 * KN)


def test_moduli_of_the_triangular_lattice(states, measure):
    state = states.lattice("triangular")
    root = np.sqrt(3)
    assert measure(state, "contact_bulk_modulus", kn=KN, kt=KT) == pytest.approx([root / 2 * KN], rel=1e-12)
    assert measure(state, "contact_shear_modulus", kn=KN, kt=KT) == pytest.approx([root / 4 * (KN + KT)], rel=1e-12)
    assert measure(state, "stiffness_anisotropy", kn=KN) == pytest.approx([0.0], abs=1e-12)
    assert measure(state, "principal_stiffness_anisotropy", kn=KN) == pytest.approx([0.0], abs=1e-12)


def test_fcc_is_cubic(states, measure):
    """12 neighbours at d (1,1,0)/sqrt2, 4/(sqrt2 d)^3 particles a volume: C_1111 = sqrt2 k_n/d, C_1122, C_1212 half."""
    overlap = 1e-3
    C = measure(states.lattice("fcc", overlap, repeats=3), "normal_stiffness", kn=KN)[0]
    unit = KN / (2 * states.R * (1 - overlap))
    expected = np.diag([2.0] * 3 + [1.0] * 3)
    expected[:3, :3] += 1.0 - np.eye(3)
    np.testing.assert_allclose(C, expected * unit / np.sqrt(2), rtol=1e-12, atol=1e-11 * unit)


@pytest.mark.parametrize(("dim", "kt"), [(2, 0.7), (3, 0.0), (3, 0.7)])
def test_it_is_the_stress_per_affine_strain(states, measure, dim, kt):
    """Random contacts on straight branches; forces of springs under u = -eps x; symmetric eps, any sizes."""
    rng = np.random.default_rng(4)
    n, box = 6, np.array([[0.0, 3.0]] * dim)
    x = rng.uniform(0, 3, (n, dim))
    i, j = np.array([(a, b) for a in range(n) for b in range(a)]).T
    part = rng.uniform(0.2, 0.8, (len(i), 1))
    eps = rng.normal(size=(dim, dim))
    eps = (eps + eps.T) / 2
    branch = x[j] - x[i]
    direction = branch / np.linalg.norm(branch, axis=1, keepdims=True)
    approach = branch @ eps
    along = (approach * direction).sum(axis=1, keepdims=True) * direction
    kn = rng.uniform(1, 2, len(i))
    force = -kn[:, None] * along - kt * (approach - along)
    state = states.snapshot(
        x=x, radius=np.ones(n), i=i + 1, j=j + 1, point=x[i] + part * branch, force=force, box=box,
    )
    ends, cells = contact_ends(state), make_cells("box", state)
    C = (normal_stiffness(ends, cells, kn) + tangential_stiffness(ends, cells, np.full(len(i), kt)))[0]
    sigma = stress(ends, cells)[0]
    np.testing.assert_allclose(np.einsum("abcd,cd->ab", C, eps), (sigma + sigma.T) / 2, rtol=1e-12, atol=1e-12)


def test_isotropic_tensors_give_their_moduli():
    for dim in (2, 3):
        one = np.eye(dim)
        lame, mu = 3.0, 5.0
        C = lame * np.einsum("ab,cd->abcd", one, one) + mu * (
            np.einsum("ac,bd->abcd", one, one) + np.einsum("ad,bc->abcd", one, one)
        )
        assert contact_bulk_modulus(C[None]) == pytest.approx([lame + 2 * mu / dim])
        assert contact_shear_modulus(C[None]) == pytest.approx([mu])
        assert stiffness_anisotropy(C[None]).tolist() == [0.0]


def _without_rows(states, state, keep):
    return states.replace(state, contacts={k: v[keep] for k, v in state.contacts.items()})


def test_anisotropy_of_a_lattice_that_lost_contacts(states, measure):
    """Square lattice with all bonds along x and none along y: C_D = 1; the other way round -1; turned: still 1."""
    state = states.lattice("square")
    along_x = np.abs(state.contacts["fx"]) > np.abs(state.contacts["fy"])
    for keep, expected in ((along_x, 1.0), (~along_x, -1.0)):
        part = _without_rows(states, state, keep)
        assert measure(part, "stiffness_anisotropy", kn=KN) == pytest.approx([expected], rel=1e-12)
        assert measure(part, "principal_stiffness_anisotropy", kn=KN) == pytest.approx([1.0], rel=1e-12)
    angle = np.radians(25.0)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    open_state = states.replace(_without_rows(states, state, along_x), periodic=None, box=None)
    near = np.abs(_branch(open_state)).max(axis=1) < states.R * 1.5  # not across the former border
    turned = states.replace(states.moved(_without_rows(states, open_state, near), turn, np.zeros(2)), box=state.box)
    assert measure(turned, "principal_stiffness_anisotropy", kn=KN) == pytest.approx([1.0], rel=1e-10)
    cos4, sin4 = np.cos(angle) ** 4, np.sin(angle) ** 4
    assert measure(turned, "stiffness_anisotropy", kn=KN) == pytest.approx([(cos4 - sin4) / (cos4 + sin4)], rel=1e-10)


def _branch(state):
    rows = state.contacts["i"].astype(int) - 1
    return state.contacts.vector("px", "py") - state.particles.vector("x", "y")[rows]


def test_without_tangential_springs_stiffness_is_the_normal_part(states, measure):
    state = states.lattice("triangular")  # central forces, no columns u, kt
    np.testing.assert_array_equal(measure(state, "stiffness", kn=KN), measure(state, "normal_stiffness", kn=KN))
    pushed = states.replace(state, contacts={**state.contacts, "fx": state.contacts["fx"] + 1.0})
    with pytest.raises(MissingColumn, match="some forces have a tangential part"):
        measure(pushed, "stiffness", kn=KN)
    with pytest.raises(MissingColumn, match="contacts has no column 'kn'"):
        measure(state, "normal_stiffness")
