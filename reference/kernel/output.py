"""What the kernel writes: `series.csv` as it goes, `frames.h5` in one piece, marked when finished."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reference.kernel.model import Model
from reference.kernel.origin import placed
from reference.kernel.simulation import Simulation

SERIES, FRAMES = "series.csv", "frames.h5"


class SeriesWriter:
    """One line a sample: step, time, for every wall w: w_d, w_v, w_fx, w_fy[, w_fz] (17 digits).

    For every ring r: r_angle (rad since the start), r_torque (of the particles on it, about its centre), r_fx, r_fy.
    """

    def __init__(self, path: Path, model: Model, *, length: int | None = None):
        """length: bytes of an earlier run's file that are kept, None to begin a new one."""
        if length is not None:
            self._file = open(path, "r+")  # noqa: SIM115
            self._file.truncate(length)
            self._file.seek(length)
            return
        axes = "xyz"[: model.dimension]
        columns = [f"{w.name}_{q}" for w in model.walls for q in ("d", "v", *(f"f{a}" for a in axes))]
        columns += [f"{r.name}_{q}" for r in model.rings for q in ("angle", "torque", "fx", "fy")]
        self._file = open(path, "w")  # noqa: SIM115  (closed by `close`, kept open over the run)
        self._file.write(",".join(["step", "time", *columns]) + "\n")

    def write(self, simulation: Simulation) -> None:
        """Append the row of now."""
        s = simulation.state
        walls = [
            value
            for k in range(len(s.wall_d))
            for value in (s.wall_d[k], s.wall_rate[k], *s.wall_force[:, k])
        ]
        rings = [
            value
            for ring, load in zip(simulation.model.rings, ring_loads(simulation), strict=True)
            for value in (ring.angle(simulation.time), load.torque, *load.force)
        ]
        numbers = (f"{v:.17g}" for v in (simulation.time, *walls, *rings))
        self._file.write(",".join([str(s.step), *numbers]) + "\n")
        self._file.flush()

    def flushed_length(self) -> int:
        """Bring what was written to disk; return its length in bytes."""
        self._file.flush()
        os.fsync(self._file.fileno())
        return self._file.tell()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


class FramesWriter:
    """Frames in closed parts, ``frames.part<k>.h5``, which `finish` makes one file of: a killed run loses one part."""

    def __init__(self, folder: Path, model: Model, *, part: int = 0):
        """part: number of the first part that is written; earlier ones are kept, later ones deleted."""
        self._folder, self._model, self.part = folder, model, part
        for path in folder.glob("frames.part*.h5"):
            if int(path.name.removeprefix("frames.part").removesuffix(".h5")) >= part:
                path.unlink()
        self._file = self._new()

    def write(self, number: int, simulation: Simulation, *, contacts: bool) -> None:
        """Add a frame."""
        write_frame(self._file, number, simulation, contacts=contacts)

    def next_part(self) -> int:
        """Close the part, which is then on disk, and begin another; return the new one's number."""
        self._file.close()
        with open(self._path(self.part), "rb") as file:
            os.fsync(file.fileno())
        self.part += 1
        self._file = self._new()
        return self.part

    def finish(self) -> None:
        """Make one file of all parts, marked as finished."""
        import h5py

        self._file.close()
        with h5py.File(self._path(0), "a") as whole:
            for number in range(1, self.part + 1):
                with h5py.File(self._path(number)) as part:
                    for name in part.get("frame", ()):
                        part.copy(f"frame/{name}", whole.require_group("frame"))
            whole.attrs["finished"] = 1
        os.replace(self._path(0), self._folder / FRAMES)
        for number in range(1, self.part + 1):
            self._path(number).unlink()

    def close(self) -> None:
        """Close the part."""
        self._file.close()

    def _path(self, number: int) -> Path:
        return self._folder / f"frames.part{number}.h5"

    def _new(self):
        import h5py

        file = h5py.File(self._path(self.part), "w")
        file.attrs["dimension"] = self._model.dimension
        if self._model.periodic is not None:
            file.attrs["periodic"] = [length > 0 for length in self._model.periodic]
        return file


@dataclass(frozen=True, kw_only=True)
class RingLoad:
    """What particles do to a ring: torque about its centre, N m, and force, (2,) in N."""

    torque: float
    force: tuple[float, float]


def ring_loads(simulation: Simulation) -> list[RingLoad]:
    """Return the loads that acted on the rings in the last step.

    torque = sum of (x_g - c) x F_g + T_g over the glued discs: F_g the force, T_g the torque on a disc about its own
    centre (none where no law turns anything).
    """
    s, m, made = simulation.state, simulation.model, []
    for ring, part in zip(m.rings, m.ring_nodes, strict=True):
        force, couple = s.force[:, part], None if s.torque is None else s.torque[:, part]
        fx, fy = force.sum(axis=1)
        made.append(RingLoad(torque=ring.torque(s.x[:, part], force, couple), force=(float(fx), float(fy))))
    return made


def write_frame(file, number: int, simulation: Simulation, *, contacts: bool) -> None:
    """Add group ``frame/<number>`` with particles, walls and, if wanted, contacts."""
    group = file.create_group(f"frame/{number}")
    group.attrs["time"], group.attrs["step"] = simulation.time, simulation.state.step
    _write(group, "particles", particle_table(simulation))
    if simulation.model.walls or simulation.model.rings:
        _write(group, "walls", wall_table(simulation))
    if contacts:
        _write(group, "contacts", contact_table(simulation))


def particle_table(simulation: Simulation) -> dict[str, np.ndarray]:
    """Columns id, x.., v.., w.., radius, mass, inertia[, rotation] of all particles."""
    s, m = simulation.state, simulation.model
    n = m.particle_count
    axes = "xyz"[: m.dimension]
    spins = ["wz"] if m.dimension == 2 else ["wx", "wy", "wz"]
    return {
        "id": np.arange(1.0, n + 1),
        **dict(zip(axes, placed(m, s.x[:, :n]), strict=True)),
        **dict(zip((f"v{a}" for a in axes), s.v[:, :n], strict=True)),
        **dict(zip(spins, s.spin[:, :n], strict=True)),
        "radius": m.radius, "mass": m.mass, "inertia": m.inertia,
        **({} if s.turned is None else {"rotation": s.turned}),
    }


def wall_table(simulation: Simulation) -> dict[str, np.ndarray]:
    """Columns id, p., n., f. (force of the particles on the wall) of the planes, and of the rings: `_ring_table`."""
    planes = _plane_table(simulation)
    if not simulation.model.rings:
        return planes
    rings = _ring_table(simulation)
    return _joined(planes, rings) if simulation.model.walls else rings


def _plane_table(simulation: Simulation) -> dict[str, np.ndarray]:
    s, m = simulation.state, simulation.model
    axes = "xyz"[: m.dimension]
    return {
        "id": np.arange(1.0, len(s.wall_d) + 1),
        **dict(zip((f"p{a}" for a in axes), placed(m, s.x[:, m.wall_nodes]), strict=True)),
        **dict(zip((f"n{a}" for a in axes), s.wall_normal, strict=True)),
        **dict(zip((f"f{a}" for a in axes), s.wall_force, strict=True)),
    }


def _ring_table(simulation: Simulation) -> dict[str, np.ndarray]:
    """Columns id (counted on from the planes), p. (centre), radius (of the circle), f., torque about the centre."""
    m, loads = simulation.model, ring_loads(simulation)
    centres = placed(m, np.array([ring.centre for ring in m.rings]).T)
    numbers = {
        "px": centres[0], "py": centres[1],
        "radius": [ring.circle for ring in m.rings], "fx": [load.force[0] for load in loads],
        "fy": [load.force[1] for load in loads], "torque": [load.torque for load in loads],
    }
    ids = len(m.walls) + np.arange(1.0, len(m.rings) + 1)
    return {"id": ids} | {name: np.array(values, float) for name, values in numbers.items()}


def _joined(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the rows of both tables; NaN where one of them does not have a column."""
    unknown = {0: np.full(len(a["id"]), np.nan), 1: np.full(len(b["id"]), np.nan)}
    return {name: np.concatenate([a.get(name, unknown[0]), b.get(name, unknown[1])]) for name in {**a, **b}}


def contact_table(simulation: Simulation) -> dict[str, np.ndarray]:
    """Columns i, j, p., f. (on i), overlap and, if sliding has a spring, its elongation u. .

    Contacts with particles and with glued discs (j = -ring, counted on from the walls) carry the force at the full-step
    velocities of now, wall contacts (j = -wall) the force that acted in the step, as engines report it.
    """
    made = [_contact_rows(simulation, k, f) for k, f in simulation.contacts() if k.walls is None]
    made += [_contact_rows(simulation, k, k.last) for k in simulation.interactions if k.walls is not None]
    return {name: np.concatenate([rows[name] for rows in made]) for name in made[0]}


def _contact_rows(simulation: Simulation, interaction, forces) -> dict[str, np.ndarray]:
    s, m = simulation.state, simulation.model
    c = forces.contact
    axes = "xyz"[: m.dimension]
    reach = s.radius[c.i] - c.overlap * (0.5 if interaction.walls is None else 1.0)
    point = placed(m, s.x[:, c.i] - reach * c.n)
    rows = {
        "i": c.i + 1.0,
        "j": _partners(m)[c.j],
        **dict(zip((f"p{a}" for a in axes), point, strict=True)),
        **dict(zip((f"f{a}" for a in axes), forces.force, strict=True)),
        "overlap": c.overlap,
    }
    if m.sliding is not None and m.sliding.memory_rows(m.dimension):
        spring = forces.memory.get("sliding", np.zeros_like(c.n))  # a smooth wall stretches none
        rows |= dict(zip((f"u{a}" for a in axes), spring[: m.dimension], strict=True))
    return rows


def _partners(model: Model) -> np.ndarray:
    """Return what contacts call each node: the id of a particle, minus the number of a wall or ring, (n,)."""
    walls, discs = len(model.walls), [len(ring.radius) for ring in model.rings]
    particles, planes = np.arange(1.0, model.particle_count + 1), -np.arange(1.0, walls + 1)
    return np.concatenate([particles, planes, np.repeat(-walls - np.arange(1.0, len(discs) + 1), discs)])


def _write(group, name: str, table: dict[str, np.ndarray]) -> None:
    for column, values in table.items():
        group[f"{name}/{column}"] = values
