"""Output of a LAMMPS run of this project: series.dat, walls.dat, frames.dump, contacts.*.dump.

What the deck writes, and what is made of it here:

series.dat            step, time, and per wall: displacement along the normal, rate (moving walls only:
                      those of a fixed wall are 0), force of the particles on it; per ring torque and force
walls.dat             the same columns at the frames
frames.dump           particles with unwrapped positions; with contact output also, per wall, a flag
                      and the force of the wall on the particle
contacts.total.dump   pairs in contact: distance, normal force, and the tangential force on the first atom
contacts.springs.dump the same at v = w = 0 without slip, so that the tangential force is -k u
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

SERIES, WALLS, FRAMES = "series.dat", "walls.dat", "frames.dump"
TOTAL, SPRINGS = "contacts.total.dump", "contacts.springs.dump"

FrameList = list[tuple[int, Columns]]


@dataclass(frozen=True, kw_only=True)
class Plane:
    """A wall as the run had it: start point (dim,), unit normal (dim,) to the particles' side.

    A moving plane is displaced along its normal, or by velocity * time (m/s, any direction) if that
    is given. smooth: it carries no tangential force, so its contacts have no springs.
    """

    index: int
    name: str
    point: tuple[float, ...]
    normal: tuple[float, ...]
    moving: bool
    velocity: tuple[float, ...] | None
    smooth: bool


def read_lammps(
    folder: Path,
    *,
    dimension: int,
    planes: Sequence[Plane],
    periodic: Sequence[float] | None,
    inertia_factor: np.ndarray,
    contacts: bool,
    sliding: bool,
    spring_stiffness: float | None,
    rotations: bool = False,
    rings: Sequence[GluedRing] = (),
) -> Trajectory:
    """Read a finished run.

    inertia_factor: (N,), q in I = q m R^2. periodic: box length of each axis in m, 0 for open axes,
    or None. contacts, rotations: did the run write them. sliding: contacts have
    tangential forces. spring_stiffness: k in N/m of the clones that tell the springs, None if there are no springs.
    Positions are unwrapped: a particle that crosses a periodic boundary goes on.

    Raises ReadError (file, line) on files that are missing, cut short, not numbers, or do not
    belong together.
    """
    folder = Path(folder)
    reader = _Reader(folder, dimension, tuple(planes), tuple(rings), periodic, sliding, spring_stiffness)
    series = reader.table(SERIES)
    particles = read_dump(folder / FRAMES, kind="ATOMS", names=reader.particle_columns(contacts, rotations))
    steps = [step for step, _ in particles]
    times = _times(series, steps, folder)
    turned = summed_rotations([t["mean_spin"] for _, t in particles], times) if rotations else [None] * len(steps)
    states = reader.wall_states(steps)
    pairs = reader.pairs(steps) if contacts else [None] * len(steps)
    frames = tuple(
        check_snapshot(folder, reader.snapshot(time, table, wall, pair, inertia_factor, angle), f"step {step}: ")
        for time, (step, table), wall, pair, angle in zip(times, particles, states, pairs, turned, strict=True)
    )
    return Trajectory(frames=frames, steps=tuple(steps), series=series)


def _times(series: Columns, steps: Sequence[int], folder: Path) -> np.ndarray:
    """Return the times of the frames: steps times the time step that the series shows."""
    last = series.rows - 1
    if last == 0:
        if max(steps) > 0:
            raise ReadError(f"{folder / SERIES}: one row, but frames up to step {max(steps)}")
        return np.zeros(len(steps))
    return np.asarray(steps, float) * (series["time"][last] / series["step"][last])


@dataclass(frozen=True)
class _Reader:
    folder: Path
    dimension: int
    planes: tuple[Plane, ...]
    rings: tuple[GluedRing, ...]
    periodic: Sequence[float] | None
    sliding: bool
    spring_stiffness: float | None

    @property
    def axes(self) -> str:
        return "xyz"[: self.dimension]

    def table(self, name: str) -> Columns:
        """Read a table and add what is true of fixed walls, which do not move, and of rings, which turn uniformly."""
        found = read_table(self.folder / name)
        still = {f"{p.name}_{c}" for p in self.planes if not p.moving for c in "dv"}
        wanted = [f"{p.name}_{c}" for p in self.planes for c in ("d", "v", *(f"f{a}" for a in self.axes))]
        wanted += [f"{r.name}_{c}" for r in self.rings for c in COLUMNS]
        missing = [c for c in ("step", "time", *wanted) if c not in found and c not in still]
        if missing:
            raise ReadError(f"{self.folder / name}: has no column {missing[0]!r}; it has {' '.join(found)}")
        zero = np.zeros(found.rows)
        columns = {c: zero if c in still else found[c] for c in ("step", "time", *wanted)}
        return Columns(columns | ring_series(self.rings, found["time"]), "series")

    def particle_columns(self, contacts: bool, rotations: bool) -> dict[str, str]:
        """Return the columns of frames.dump and the names they get here."""
        spins = "z" if self.dimension == 2 else "xyz"
        plain = ["id", "radius", "mass", *(f"{a}u" for a in self.axes), *(f"v{a}" for a in self.axes)]
        names = {c: c for c in (*plain, *(f"omega{a}" for a in spins))}
        if rotations:
            names["f_mean_spin"] = "mean_spin"
        if contacts:
            for p in self.planes:
                names[f"f_wall_{p.name}[1]"] = f"{p.name}_touches"
                names |= {f"f_wall_{p.name}[{k + 2}]": f"{p.name}_f{a}" for k, a in enumerate(self.axes)}
        return names

    def wall_states(self, steps: Sequence[int]) -> list[Columns | None]:
        """Return the walls table of every frame."""
        if not self.planes and not self.rings:
            return [None] * len(steps)
        table = self.table(WALLS)
        if not np.array_equal(table["step"], steps):
            raise ReadError(f"{self.folder / WALLS}: its steps are not those of {FRAMES}")
        planes = [wall_rows(self.planes, table, k) if self.planes else None for k in range(table.rows)]
        return [with_ring_rows(rows, self.rings, table, k) for k, rows in enumerate(planes)]

    def pairs(self, steps: Sequence[int]) -> list[tuple[Columns, Columns | None]]:
        """Return the contacts of every frame: total forces, and springs if there are any."""
        total = self._local(TOTAL, steps)
        if self.spring_stiffness is None:
            return [(t, None) for t in total]
        springs = self._local(SPRINGS, steps)
        for step, t, s in zip(steps, total, springs, strict=True):
            if not all(np.array_equal(t[c], s[c]) for c in ("first", "second")):
                raise ReadError(f"{self.folder / SPRINGS}: step {step}: its pairs are not those of {TOTAL}")
        return list(zip(total, springs, strict=True))

    def _local(self, name: str, steps: Sequence[int]) -> list[Columns]:
        names = {"c_ids[1]": "first", "c_ids[2]": "second", "c_pair[1]": "distance", "c_pair[2]": "normal"}
        if self.sliding:
            names |= {f"c_pair[{k + 3}]": f"t{a}" for k, a in enumerate(self.axes)}
        frames = read_dump(self.folder / name, kind="ENTRIES", names=names)
        if [step for step, _ in frames] != list(steps):
            raise ReadError(f"{self.folder / name}: its steps are not those of {FRAMES}")
        return [table for _, table in frames]

    def snapshot(
        self, time: float, atoms: Columns, walls: Columns | None, pairs, inertia_factor: np.ndarray,
        turned: np.ndarray | None,
    ) -> Snapshot:
        """Put one frame together."""
        particles = particle_rows(self.folder / FRAMES, atoms, self.dimension, inertia_factor, "u", turned)
        contacts = None
        if pairs is not None:
            rows = [self._pair_rows(particles, time, *pairs)]
            rows += [self._wall_rows(particles, atoms, walls, k) for k in range(len(self.planes))]
            contacts = Columns({c: np.concatenate([r[c] for r in rows]) for c in rows[0]}, "contacts")
        return Snapshot(
            time=float(time), dimension=self.dimension, particles=particles, contacts=contacts, walls=walls,
            box=box_from_walls(walls, self.dimension, self.periodic),
            periodic=None if self.periodic is None else tuple(length > 0 for length in self.periodic),
        )

    def _pair_rows(
        self, particles: Columns, time: float, total: Columns, springs: Columns | None
    ) -> dict[str, np.ndarray]:
        """Return contacts with particles, i < j, and glued discs, sorted: f = f_n n + f_t, u = -f_t(springs)/k.

        LAMMPS gives the tangential force on the first atom of its pair, which is i or j.
        """
        bodies = with_glued_discs(particles, self.rings, time)
        first, second = total["first"].astype(int), total["second"].astype(int)
        i, j, sign = np.minimum(first, second), np.maximum(first, second), np.where(first < second, 1.0, -1.0)
        normal, overlap, point = pair_geometry(bodies, i, j, self.axes, self.periodic)
        self._agree(bodies["radius"][i - 1] + bodies["radius"][j - 1] - overlap, total["distance"])
        force = total["normal"][:, None] * normal
        if self.sliding:
            force += sign[:, None] * self._tangential(total)
        columns = {"i": i, "j": name_rings(j, particles.rows, self.rings)} | spread("p", point) | spread("f", force)
        if springs is not None:
            columns |= spread("u", -sign[:, None] * self._tangential(springs) / self.spring_stiffness)
        order = np.lexsort((j, i))
        return {c: v[order] for c, v in (columns | {"overlap": overlap}).items()}

    def _tangential(self, table: Columns) -> np.ndarray:
        return table.vector(*(f"t{a}" for a in self.axes))

    def _agree(self, distance: np.ndarray, told: np.ndarray) -> None:
        """Refuse contacts that are not between the particles of this frame."""
        off = np.abs(distance - told)
        if off.size and off.max() > 1e-9 * distance.max():
            raise ReadError(f"{self.folder / TOTAL}: a distance is {off.max():.3g} m off that in {FRAMES}")

    def _wall_rows(self, particles: Columns, atoms: Columns, walls: Columns, k: int) -> dict[str, np.ndarray]:
        """Return the contacts with plane k: the foot of the particle's centre, the force LAMMPS applied."""
        plane = self.planes[k]
        touching = atoms[f"{plane.name}_touches"] > 0
        n = np.array(plane.normal)
        x = particles.vector(*self.axes)[touching]
        distance = (x - [walls[f"p{a}"][k] for a in self.axes]) @ n
        columns = {"i": particles["id"][touching], "j": np.full(len(x), -float(plane.index))}
        columns |= spread("p", x - distance[:, None] * n)
        columns |= {f"f{a}": atoms[f"{plane.name}_f{a}"][touching] for a in self.axes}
        if self.spring_stiffness is not None:
            columns |= spread("u", np.full(x.shape, 0.0 if plane.smooth else np.nan))
        return columns | {"overlap": particles["radius"][touching] - distance}
