"""States with known answers, as one fixture: `states.<builder>(...)`."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest

from postproc.snapshot import Columns, Snapshot

AXES = "xyz"
R = 0.5e-3
KN = 1e5


def columns(letter: str, array: np.ndarray) -> dict[str, np.ndarray]:
    """Split (rows, dim) into columns <letter>x, ..."""
    array = np.asarray(array, dtype=float)
    return {letter + AXES[k]: array[:, k] for k in range(array.shape[1])}


def snapshot(*, x, radius, i=(), j=(), point=None, force=None, walls=None, extra=None, **rest) -> Snapshot:
    """Build a snapshot from arrays; extra: {"particles" or "contacts": further columns}."""
    x = np.asarray(x, dtype=float)
    extra = extra or {}
    point = np.empty((0, x.shape[1])) if point is None else point
    force = np.empty((0, x.shape[1])) if force is None else force
    particles = {"id": np.arange(1, len(x) + 1), **columns("", x), "radius": radius, **extra.get("particles", {})}
    contacts = {"i": i, "j": j, **columns("p", point), **columns("f", force), **extra.get("contacts", {})}
    return Snapshot(
        dimension=x.shape[1],
        particles=Columns(particles, "particles"),
        contacts=Columns(contacts, "contacts"),
        walls=None if walls is None else Columns(walls, "walls"),
        **{"time": 0.0, **rest},
    )


UNIT_CELLS = {
    "square": ((1.0, 1.0), [(0.0, 0.0)]),
    "triangular": ((1.0, np.sqrt(3.0)), [(0.0, 0.0), (0.5, np.sqrt(3.0) / 2.0)]),
    "cubic": ((1.0, 1.0, 1.0), [(0.0, 0.0, 0.0)]),
    "fcc": (
        (np.sqrt(2.0),) * 3,
        [(0.0, 0.0, 0.0)] + [tuple(np.sqrt(0.5) * np.array(c)) for c in ((0, 1, 1), (1, 0, 1), (1, 1, 0))],
    ),
}
"""Edges of a rectangular cell and its particles, in units of the distance of neighbours."""


def lattice(kind: str, overlap: float = 1e-3, repeats: int = 4, **rest) -> Snapshot:
    """Return a periodic lattice; overlap in units of the diameter, normal force KN * overlap.

    Neighbours are found here by brute force over images, not by the code under test.
    """
    spacing = 2 * R * (1 - overlap)
    edges, basis = (spacing * np.array(a) for a in UNIT_CELLS[kind])
    dim = len(edges)
    cells = np.stack(np.meshgrid(*[range(repeats)] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    x = (cells[:, None] * edges + basis).reshape(-1, dim)
    length = repeats * edges
    rows = []
    for a, b in combinations(range(len(x)), 2):
        branch = x[a] - x[b]
        branch = branch - length * np.round(branch / length)
        gap = 2 * R - np.linalg.norm(branch)
        if gap > 0.5 * overlap * 2 * R:
            n = branch / np.linalg.norm(branch)
            rows.append((a + 1, b + 1, x[a] - (R - gap / 2) * n, KN * gap * n, gap))
    i, j, point, force, gap = (np.array(c) for c in zip(*rows, strict=True))
    return snapshot(
        x=x, radius=np.full(len(x), R), i=i, j=j, point=point, force=force,
        box=np.column_stack([np.zeros(dim), length]), periodic=(True,) * dim,
        extra={"contacts": {"overlap": gap}}, **rest,
    )


def random_contacts(seed: int, dim: int, count: int = 9) -> Snapshot:
    """Return particles of random sizes at random places in a closed box, random contacts and forces.

    Contact points lie anywhere near the particles and forces point anywhere: sum rules must hold
    for any such state. Every particle touches something, several touch walls.
    """
    rng = np.random.default_rng(seed)
    box = np.column_stack([rng.uniform(-3, -1, dim), rng.uniform(1, 3, dim)])
    x = rng.uniform(*box.T, (count, dim))
    radius = rng.uniform(0.1, 0.4, count)
    pairs = [p for p in combinations(range(count), 2) if rng.random() < 0.5 or p[1] == p[0] + 1]
    i, j = np.array(pairs).T
    pair_points = (x[i] + x[j]) / 2 + rng.normal(0, 0.05, (len(i), dim))
    wall_i = rng.integers(0, count, 4 * dim)
    wall = np.arange(4 * dim) % (2 * dim)
    wall_points = x[wall_i].copy()
    wall_points[np.arange(4 * dim), wall // 2] = box[wall // 2, wall % 2]
    force = rng.normal(0, 1, (len(i) + 4 * dim, dim))
    return snapshot(
        x=x, radius=radius, box=box,
        i=np.concatenate([i, wall_i]) + 1, j=np.concatenate([j + 1, -(wall + 1)]),
        point=np.concatenate([pair_points, wall_points]), force=force,
        extra={
            "particles": {
                "mass": rng.uniform(1, 2, count), "inertia": rng.uniform(1, 2, count),
                **columns("v", rng.normal(size=(count, dim))),
                **{"w" + a: rng.normal(size=count) for a in ("z" if dim == 2 else "xyz")},
            },
            "contacts": {
                "overlap": rng.uniform(0, 0.1, len(force)), "kn": rng.uniform(1, 2, len(force)),
                "kt": rng.uniform(1, 2, len(force)), **columns("u", rng.normal(size=force.shape)),
            },
        },
        walls=_faces(box, wall, force[len(i):]),
    )


def _faces(box: np.ndarray, wall: np.ndarray, force_on_particle: np.ndarray) -> dict:
    dim = len(box)
    total = np.zeros((2 * dim, dim))
    np.add.at(total, wall, -force_on_particle)
    point, normal = np.zeros((2 * dim, dim)), np.zeros((2 * dim, dim))
    for w in range(2 * dim):
        point[w, w // 2], normal[w, w // 2] = box[w // 2, w % 2], 1.0 - 2.0 * (w % 2)
    return {"id": np.arange(1, 2 * dim + 1), **columns("p", point), **columns("n", normal), **columns("f", total)}


def balanced(seed: int, dim: int) -> Snapshot:
    """Return `random_contacts` with the forces projected so that they sum to zero on every particle."""
    state = random_contacts(seed, dim)
    c, n = state.contacts, state.particles.rows
    force = c.vector(*("f" + a for a in state.axes))
    signs = np.zeros((n, c.rows))
    for row, (i, j) in enumerate(zip(c["i"], c["j"], strict=True)):
        signs[int(i) - 1, row] = 1.0
        if j > 0:
            signs[int(j) - 1, row] = -1.0
    force = force - np.linalg.pinv(signs) @ (signs @ force)
    at_wall = c["j"] < 0
    walls = _faces(state.box, (-c["j"][at_wall] - 1).astype(int), force[at_wall])
    return replace(state, contacts={**c, **columns("f", force)}, walls=walls)


def replace(state: Snapshot, **changes) -> Snapshot:
    """Return a copy; groups may be given as plain dicts."""
    import dataclasses

    made = {k: Columns(v, k) if isinstance(v, dict) else v for k, v in changes.items()}
    return dataclasses.replace(state, **made)


def without(state: Snapshot, group: str, *names: str) -> Snapshot:
    """Return a copy that lacks these columns."""
    table = getattr(state, group)
    return replace(state, **{group: {k: v for k, v in table.items() if k not in names}})


def moved(state: Snapshot, turn: np.ndarray, shift: np.ndarray) -> Snapshot:
    """Return the particles and contacts turned by the matrix `turn`, then shifted; no box, no walls."""
    def turned(table: Columns, letter: str, offset=0.0) -> dict:
        names = [letter + a for a in state.axes]
        return columns(letter, table.vector(*names) @ turn.T + offset) if names[0] in table else {}

    p, c = state.particles, state.contacts
    return replace(
        state, box=None, walls=None,
        particles={**p, **turned(p, "", shift), **turned(p, "v")},
        contacts={**c, **turned(c, "p", shift), **turned(c, "f"), **turned(c, "u")},
    )


WORDS = {
    2: {"rings": "rings:5:0.1:1.0", "strips": "strips:x:4", "grid": "grid:3x4", "halfplane": "halfplane:1,2:0.1",
        "points": "points:3x4"},
    3: {"rings": "rings:5:0.1:1.0", "strips": "strips:z:4", "grid": "grid:2x3x2", "halfplane": "halfplane:1,2,1:0.1",
        "points": "points:2x3x2"},
}
"""Cells that lie in the box of `random_contacts`, by kind; kinds that need no words are left out."""


def words(kind: str, dim: int) -> str:
    """Return how cells of this kind are asked for in a random state."""
    return WORDS[dim].get(kind, kind)


@pytest.fixture(scope="session")
def states() -> SimpleNamespace:
    """Builders of states, and the radius and stiffness that lattices use."""
    return SimpleNamespace(
        snapshot=snapshot, lattice=lattice, random_contacts=random_contacts, balanced=balanced,
        replace=replace, without=without, moved=moved, columns=columns, words=words, R=R, KN=KN,
    )
