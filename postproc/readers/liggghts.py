"""Output of a LIGGGHTS run of this project: series.txt, particles.dump, contacts.dump, mesh_contacts.dump.

series.txt          thermodynamic output at samples and frames: step, atoms, kinetic energy, then per wall:
                    displacement along the normal and rate (moving walls only: those of a wall that stays
                    are 0), force of the particles on it; per ring torque and force. LIGGGHTS cuts the names
                    in its header line to eight letters, so columns go by their order.
particles.dump      particles (unwrapped positions if an axis is periodic); with contact output also the
                    force of every primitive plane and of all meshes together on the particle
contacts.dump       pairs: ids, is it across a periodic boundary, force on the first, what the contact
                    remembers (if that has a spring), overlap
mesh_contacts.dump  only where meshes have friction or normals that depend on each other: mesh, triangle,
                    particle, force, what the contact remembers, overlap
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from postproc.readers.check import check_snapshot
from postproc.readers.dump import read_dump, read_table
from postproc.readers.rings import (
    COLUMNS,
    GluedRing,
    name_rings,
    ring_series,
    with_glued_discs,
    with_ring_rows,
)
from postproc.readers.rows import pair_geometry, particle_rows, spread, summed_rotations, wall_rows
from postproc.readers.walls import box_from_walls
from postproc.snapshot import Columns, Snapshot
from postproc.trajectory import ReadError, Trajectory

SERIES, PARTICLES, CONTACTS, MESH_CONTACTS = "series.txt", "particles.dump", "contacts.dump", "mesh_contacts.dump"


@dataclass(frozen=True, kw_only=True)
class LiggghtsWall:
    """A wall as the run had it: start point (dim,), unit normal (dim,) to the particles' side.

    moves: it is displaced along its normal. velocity: m/s, of a wall with constant velocity, in any
    direction. rough: it has friction. mesh: its number among the meshes, from 0; None for a
    primitive plane.
    """

    index: int
    name: str
    point: tuple[float, ...]
    normal: tuple[float, ...]
    moves: bool
    velocity: tuple[float, ...] | None
    rough: bool
    mesh: int | None


def read_liggghts(
    folder: Path,
    *,
    dimension: int,
    walls: Sequence[LiggghtsWall],
    periodic: Sequence[float] | None,
    inertia_factor: np.ndarray,
    dt: float,
    sample_every: int,
    contacts: bool,
    history: Sequence[str],
    rotations: bool = False,
    rings: Sequence[GluedRing] = (),
) -> Trajectory:
    """Read a finished run.

    periodic: box length of each axis in m, 0 for open axes, or None. inertia_factor: (N,), q in
    I = q m R^2. dt: time step in s; sample_every: steps between the rows of the series. contacts, rotations:
    did the run write them. history: names of the numbers that contacts remember, as far as they are told, in
    their order; `ux`, `uy`, `uz` are the spring.

    Forces of particles on each other are total, with full-step velocities. Forces of walls are those
    applied in that step (half-step velocities), except on a particle that touches two meshes at once
    in a run with rough meshes, or with meshes whose normals depend on each other: there they too are
    evaluated with full-step velocities. The spring of a smooth wall is 0.

    Raises ReadError (file, line) on files that are missing, cut short, not numbers, or do not belong
    together.
    """
    reader = _Reader(
        Path(folder), dimension, tuple(walls), tuple(rings), periodic, inertia_factor, dt, contacts, tuple(history)
    )
    table = reader.wall_table()
    atoms = read_dump(reader.folder / PARTICLES, kind="ATOMS")
    steps = [step for step, _ in atoms]
    turned = [None] * len(steps)
    if rotations:
        turned = summed_rotations([frame["f_mean_spin"] for _, frame in atoms], [step * dt for step in steps])
    pairs = reader.local(CONTACTS, "pairs", _PAIR, steps) if contacts else [None] * len(steps)
    shares = reader.shares(steps)
    frames = tuple(
        check_snapshot(reader.folder, reader.snapshot(step, frame, table, pair, share, angle), f"step {step}: ")
        for (step, frame), pair, share, angle in zip(atoms, pairs, shares, turned, strict=True)
    )
    samples = table["step"] % sample_every == 0
    series = Columns({name: values[samples] for name, values in table.items()}, "series")
    return Trajectory(frames=frames, steps=tuple(steps), series=series)


_PAIR, _SHARE = ("first", "second", "across"), ("mesh", "triangle", "particle")
"""The three ids that begin a row of contacts.dump, and of mesh_contacts.dump."""

Rows = dict[str, np.ndarray]

Told = dict[tuple[int, int], np.ndarray]
"""Force and spring, (2, dim), by number of the mesh and id of the particle."""


@dataclass(frozen=True)
class _Reader:
    folder: Path
    dimension: int
    walls: tuple[LiggghtsWall, ...]
    rings: tuple[GluedRing, ...]
    periodic: Sequence[float] | None
    inertia_factor: np.ndarray
    dt: float
    contacts: bool
    history: tuple[str, ...]

    @property
    def sliding(self) -> bool:
        """Do contacts have springs?"""
        return "ux" in self.history

    @property
    def axes(self) -> str:
        return "xyz"[: self.dimension]

    # --- series and walls ----------------------------------------------------------------------

    def wall_table(self) -> Columns:
        """Return step, time and the columns of every wall and ring, at samples and frames."""
        names = ["step", "atoms", "energy"]
        for wall in self.walls:
            names += [f"{wall.name}_{c}" for c in ((*"dv",) if wall.moves else ())]
            names += [f"{wall.name}_f{a}" for a in self.axes]
        told = [f"{ring.name}_{c}" for ring in self.rings for c in COLUMNS]
        names += told
        found = read_table(self.folder / SERIES, names=names)
        columns = {"step": found["step"], "time": found["step"] * self.dt}
        for wall in self.walls:
            for c in "dv":
                columns[f"{wall.name}_{c}"] = found[f"{wall.name}_{c}"] if wall.moves else np.zeros(found.rows)
            columns |= {f"{wall.name}_f{a}": found[f"{wall.name}_f{a}"] for a in self.axes}
        columns |= {c: found[c] for c in told} | ring_series(self.rings, columns["time"])
        return Columns(columns, "series")

    def _walls_at(self, step: int, table: Columns) -> Columns | None:
        if not self.walls and not self.rings:
            return None
        row = int(np.searchsorted(table["step"], step))
        if row == table.rows or table["step"][row] != step:
            raise ReadError(f"{self.folder / SERIES}: has no row of step {step}, which {PARTICLES} has")
        planes = wall_rows(self.walls, table, row) if self.walls else None
        return with_ring_rows(planes, self.rings, table, row)

    # --- frames --------------------------------------------------------------------------------

    def snapshot(
        self, step: int, atoms: Columns, table: Columns, pairs: Columns | None, shares: Columns | None,
        turned: np.ndarray | None,
    ) -> Snapshot:
        """Put one frame together."""
        unwrapped = "" if self.periodic is None else "u"
        particles = particle_rows(
            self.folder / PARTICLES, atoms, self.dimension, self.inertia_factor, unwrapped, turned
        )
        walls = self._walls_at(step, table)
        contacts = None
        if pairs is not None:
            rows = [self._pair_rows(particles, step * self.dt, pairs)]
            rows += self._wall_rows(particles, atoms, walls, shares)
            contacts = Columns({c: np.concatenate([r[c] for r in rows]) for c in rows[0]}, "contacts")
        return Snapshot(
            time=step * self.dt, dimension=self.dimension, particles=particles, contacts=contacts, walls=walls,
            box=box_from_walls(walls, self.dimension, self.periodic),
            periodic=None if self.periodic is None else tuple(length > 0 for length in self.periodic),
        )

    # --- contacts ------------------------------------------------------------------------------

    def local(self, name: str, compute: str, ids: Sequence[str], steps: Sequence[int]) -> list[Columns]:
        """Return a dump of local data, frame by frame: ids, force, spring if there is one, overlap."""
        columns = [*ids, "fx", "fy", "fz", *(self.history if self._is_rough(compute) else ()), "overlap"]
        names = {f"c_{compute}[{k + 1}]": c for k, c in enumerate(columns)}
        frames = read_dump(self.folder / name, kind="ENTRIES", names=names)
        if [step for step, _ in frames] != list(steps):
            raise ReadError(f"{self.folder / name}: its steps are not those of {PARTICLES}")
        return [table for _, table in frames]

    def shares(self, steps: Sequence[int]) -> list[Columns | None]:
        """Return the contacts with meshes, where the run had to write them."""
        meshes = [w for w in self.walls if w.mesh is not None]
        if not self.contacts or not meshes:
            return [None] * len(steps)
        rank = np.linalg.matrix_rank(np.array([w.normal for w in meshes]))
        if rank == len(meshes) and not any(w.rough for w in meshes):
            return [None] * len(steps)
        return self.local(MESH_CONTACTS, "shares", _SHARE, steps)

    def _is_rough(self, compute: str) -> bool:
        return compute == "pairs" or any(w.rough for w in self.walls if w.mesh is not None)

    def _pair_rows(self, particles: Columns, time: float, pairs: Columns) -> Rows:
        """Return contacts with particles, i < j, and glued discs, sorted; LIGGGHTS tells of the first what it feels."""
        bodies = with_glued_discs(particles, self.rings, time)
        touching = pairs["overlap"] > 0
        first, second = (pairs[c][touching].astype(int) for c in ("first", "second"))
        i, j, sign = np.minimum(first, second), np.maximum(first, second), np.where(first < second, 1.0, -1.0)
        _, overlap, point = pair_geometry(bodies, i, j, self.axes, self.periodic)
        self._agree(overlap, pairs["overlap"][touching], particles)
        vector = {c: sign[:, None] * pairs.vector(*(c + a for a in self.axes))[touching] for c in self._vectors}
        columns = {"i": i, "j": name_rings(j, particles.rows, self.rings)} | spread("p", point)
        for letter, values in vector.items():
            columns |= spread(letter, values)
        columns["overlap"] = overlap
        order = np.lexsort((j, i))
        return {c: v[order] for c, v in columns.items()}

    @property
    def _vectors(self) -> str:
        return "fu" if self.sliding else "f"

    def _agree(self, overlap: np.ndarray, told: np.ndarray, particles: Columns) -> None:
        """Refuse contacts that are not between the particles of this frame."""
        off = np.abs(overlap - told)
        if off.size and off.max() > 1e-9 * particles["radius"].max():
            raise ReadError(f"{self.folder / CONTACTS}: an overlap is {off.max():.3g} m off that of {PARTICLES}")

    def _wall_rows(
        self, particles: Columns, atoms: Columns, walls: Columns | None, shares: Columns | None
    ) -> list[Rows]:
        """Return the contacts with each wall: the particles that overlap it, at the foot of their centre."""
        if not self.walls:
            return []
        x, points = particles.vector(*self.axes), walls.vector(*("p" + a for a in self.axes))[: len(self.walls)]
        normals = np.array([w.normal for w in self.walls])
        distance = np.stack([(x - p) @ n for p, n in zip(points, normals, strict=True)], axis=1)
        touches = distance < particles["radius"][:, None]
        forces, springs = self._plane_vectors(atoms, len(x))
        self._fill_in_meshes(atoms, touches, self._told(shares), forces, springs)
        rows = []
        for k, wall in enumerate(self.walls):
            t = touches[:, k]
            columns = {"i": particles["id"][t], "j": np.full(t.sum(), -float(wall.index))}
            columns |= spread("p", x[t] - distance[t, k, None] * normals[k]) | spread("f", forces[t, k])
            if self.sliding:
                columns |= spread("u", springs[t, k])
            rows.append(columns | {"overlap": (particles["radius"] - distance[:, k])[t]})
        return rows

    def _plane_vectors(self, atoms: Columns, count: int) -> tuple[np.ndarray, np.ndarray]:
        """Return forces and springs (N, walls, dim): those of primitive planes, NaN forces for meshes."""
        forces = np.full((count, len(self.walls), self.dimension), np.nan)
        springs = np.zeros_like(forces)
        for k, wall in enumerate(self.walls):
            if wall.mesh is None:
                forces[:, k] = self._per_atom(atoms, f"f_force_{wall.name}_plane")
                if wall.rough and self.sliding:
                    springs[:, k] = self._per_atom(atoms, f"f_history_{wall.name}_plane", self.history.index("ux"))
        return forces, springs

    def _per_atom(self, atoms: Columns, name: str, first: int = 0) -> np.ndarray:
        return atoms.vector(*(f"{name}[{first + k + 1}]" for k in range(self.dimension)))

    def _fill_in_meshes(
        self, atoms: Columns, touches: np.ndarray, told: Told | None, forces: np.ndarray, springs: np.ndarray
    ) -> None:
        """Set forces and springs of meshes; LIGGGHTS keeps one force for all meshes on a particle."""
        meshes = [k for k, w in enumerate(self.walls) if w.mesh is not None]
        if not meshes:
            return
        if told is not None:
            ids = range(1, len(touches) + 1)
            touches[:, meshes] = [[(self.walls[k].mesh, i) in told for k in meshes] for i in ids]
        applied = self._per_atom(atoms, "f_force_meshes")
        for row in np.flatnonzero(touches[:, meshes].any(axis=1)):
            walls = [k for k in meshes if touches[row, k]]
            values = None if told is None else np.array([told[self.walls[k].mesh, row + 1] for k in walls])
            forces[row, walls] = self._split(applied[row], walls, values)
            if values is not None:
                rough = [self.walls[k].rough for k in walls]
                springs[row, np.array(walls)[rough]] = values[rough, 1]

    def _told(self, shares: Columns | None) -> Told | None:
        """Return what LIGGGHTS tells of single contacts with meshes, None if the run did not write it."""
        if shares is None:
            return None
        force = shares.vector(*("f" + a for a in self.axes))
        spring = shares.vector(*("u" + a for a in self.axes)) if "ux" in shares else np.full_like(force, np.nan)
        keys = zip(shares["mesh"].astype(int), shares["particle"].astype(int), shares["overlap"], strict=True)
        return {(m, i): np.array([force[k], spring[k]]) for k, (m, i, overlap) in enumerate(keys) if overlap > 0}

    def _split(self, applied: np.ndarray, walls: list[int], values: np.ndarray | None) -> np.ndarray:
        """Return the share (walls, dim) of each wall in the force that all meshes apply to a particle."""
        if len(walls) == 1:
            return applied[None, :]
        if values is not None:
            return values[:, 0]
        normals = np.array([self.walls[k].normal for k in walls])
        return np.linalg.lstsq(normals.T, applied, rcond=None)[0][:, None] * normals


__all__ = ["LiggghtsWall", "ReadError", "read_liggghts"]
