"""What the kernel writes: `series.csv` as it goes, `frames.h5` in one piece, marked when finished."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from reference.kernel.model import Model
from reference.kernel.simulation import Simulation

SERIES, FRAMES = "series.csv", "frames.h5"


class SeriesWriter:
    """One line a sample: step, time and for every wall w: w_d, w_v, w_fx, w_fy[, w_fz] (17 digits)."""

    def __init__(self, path: Path, model: Model):
        axes = "xyz"[: model.dimension]
        columns = [f"{w.name}_{q}" for w in model.walls for q in ("d", "v", *(f"f{a}" for a in axes))]
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
        numbers = (f"{v:.17g}" for v in (simulation.time, *walls))
        self._file.write(",".join([str(s.step), *numbers]) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def write_frame(file, number: int, simulation: Simulation, *, contacts: bool) -> None:
    """Add group ``frame/<number>`` with particles, walls and, if wanted, contacts."""
    group = file.create_group(f"frame/{number}")
    group.attrs["time"], group.attrs["step"] = simulation.time, simulation.state.step
    _write(group, "particles", particle_table(simulation))
    if simulation.model.walls:
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
        **dict(zip(axes, s.x[:, :n], strict=True)),
        **dict(zip((f"v{a}" for a in axes), s.v[:, :n], strict=True)),
        **dict(zip(spins, s.spin[:, :n], strict=True)),
        "radius": m.radius, "mass": m.mass, "inertia": m.inertia,
        **({} if s.turned is None else {"rotation": s.turned}),
    }


def wall_table(simulation: Simulation) -> dict[str, np.ndarray]:
    """Columns id, p., n., f. (force of the particles on the wall)."""
    s, n = simulation.state, simulation.model.particle_count
    axes = "xyz"[: simulation.model.dimension]
    return {
        "id": np.arange(1.0, len(s.wall_d) + 1),
        **dict(zip((f"p{a}" for a in axes), s.x[:, n:], strict=True)),
        **dict(zip((f"n{a}" for a in axes), s.wall_normal, strict=True)),
        **dict(zip((f"f{a}" for a in axes), s.wall_force, strict=True)),
    }


def contact_table(simulation: Simulation) -> dict[str, np.ndarray]:
    """Columns i, j, p., f. (on i), overlap and, if sliding has a spring, its elongation u. .

    Particle contacts carry the force at the full-step velocities of now, wall contacts (j = -wall)
    the force that acted in the step, as engines report it.
    """
    made = [_contact_rows(simulation, k, f) for k, f in simulation.contacts() if k.walls is None]
    made += [_contact_rows(simulation, k, k.last) for k in simulation.interactions if k.walls is not None]
    return {name: np.concatenate([rows[name] for rows in made]) for name in made[0]}


def _contact_rows(simulation: Simulation, interaction, forces) -> dict[str, np.ndarray]:
    s, m = simulation.state, simulation.model
    c, n = forces.contact, m.particle_count
    axes = "xyz"[: m.dimension]
    reach = s.radius[c.i] - c.overlap * (0.5 if interaction.walls is None else 1.0)
    point = s.x[:, c.i] - reach * c.n
    rows = {
        "i": c.i + 1.0,
        "j": np.where(c.j < n, c.j + 1.0, n - c.j - 1.0),
        **dict(zip((f"p{a}" for a in axes), point, strict=True)),
        **dict(zip((f"f{a}" for a in axes), forces.force, strict=True)),
        "overlap": c.overlap,
    }
    if m.sliding is not None and m.sliding.memory_rows(m.dimension):
        spring = forces.memory.get("sliding", np.zeros_like(c.n))  # a smooth wall stretches none
        rows |= dict(zip((f"u{a}" for a in axes), spring[: m.dimension], strict=True))
    return rows


def _write(group, name: str, table: dict[str, np.ndarray]) -> None:
    for column, values in table.items():
        group[f"{name}/{column}"] = values
