"""What `grainproof scene` says: the validated scene, what follows from it, which effects are on and why."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass

import msgspec

from harness.scene.derived import Derived, PairScales, WallScales, derive
from harness.scene.effects import effects
from harness.scene.fault import path_text, show
from harness.scene.model import Scene
from harness.scene.system import System

QUASISTATIC = 1e-3
"""Inertial number below which dense flow hardly depends on the rate (GDR MiDi, Eur. Phys. J. E 14, 341 (2004))."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One line: name, value (number, text or true/false), its unit, a remark; the last two may be empty."""

    name: str
    value: float | int | str | bool
    unit: str = ""
    note: str = ""

    @property
    def text(self) -> str:
        """The value with its unit for a reader."""
        value = f"{self.value:.4g}" if isinstance(self.value, float) else show(self.value).strip('"')
        return f"{value} {self.unit}".strip()


Section = tuple[str, list[Row]]


def explain(
    scene: Scene, system: System | None = None, engines_expected: Mapping[str, float] | None = None
) -> list[Section]:
    """Return titled rows; `engines_expected` has the minutes that a run is expected to take, by engine.

    Without a system (see `harness.scene.resolve.known_system`) averages over particles are those of
    the declared distribution.
    """
    derived = derive(scene, system)
    sections = [
        ("scene", list(_scene_rows(scene))),
        ("particles", list(_particle_rows(derived))),
        ("contacts", [row for pair in derived.pairs for row in _pair_rows(scene, pair)]),
        ("time step", list(_step_rows(scene, derived))),
        ("drive", list(_drive_rows(derived))),
        ("effects", list(_effect_rows(scene, system))),
        ("expected run time", [Row(name=e, value=t, unit="min") for e, t in (engines_expected or {}).items()]),
    ]
    return [(title, rows) for title, rows in sections if rows]


def as_json(sections: list[Section]) -> dict[str, list[dict]]:
    """Return the sections as JSON-able data; infinite numbers become texts."""
    return {title: [_plain(row) for row in rows] for title, rows in sections}


def _plain(row: Row) -> dict:
    finite = not isinstance(row.value, float) or math.isfinite(row.value)
    return asdict(row) | ({} if finite else {"value": str(row.value)})


def _scene_rows(scene: Scene) -> Iterator[Row]:
    """Yield every value of the scene by its path, as it was understood; bodies as a number."""
    data = msgspec.to_builtins(scene)
    bodies = data.pop("bodies", None)
    yield from _leaves(data, [])
    if bodies:
        yield Row(name="bodies", value=len(bodies), note="particles in the scene file")


def _leaves(value: object, keys: list) -> Iterator[Row]:
    tables = isinstance(value, list | tuple) and any(isinstance(v, dict) for v in value)
    if isinstance(value, dict) or tables:
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _leaves(inner, [*keys, key])
    elif value not in (None, (), []):
        yield Row(name=path_text(keys), value=value if isinstance(value, str | int | float) else show(value))


def _particle_rows(derived: Derived) -> Iterator[Row]:
    grains = derived.grains
    source = "of the actual particles" if derived.packed else "of the declared distribution"
    yield Row(name="number", value=grains.count)
    yield Row(name="mean mass", value=grains.mean_mass, unit="kg", note=source)
    yield Row(name="total mass", value=grains.total_mass, unit="kg", note=source)
    if grains.side is not None:
        note = "of the actual box" if derived.packed else "estimated at area fraction 0.84"
        yield Row(name="height of the box", value=grains.side, unit="m", note=note)


def _pair_rows(scene: Scene, pair: PairScales) -> Iterator[Row]:
    formula = "pi/sqrt(k/m* - b^2)"
    if pair.overdamped:
        formula = f"pi/sqrt(k/m*), as the pair is overdamped (b/omega_0 = {pair.damping_ratio:.3g}): no contact time"
    yield Row(name=f"contact time, {pair.name} pair", value=pair.time_scale, unit="s", note=formula)
    yield Row(name=f"damping ratio, {pair.name} pair", value=pair.damping_ratio, note="b/omega_0; 1 is critical")
    chosen = scene.contact.normal.attraction
    for cutoff, value in (("allowed", pair.restitution_allowed), ("clipped", pair.restitution_clipped)):
        note = "as in the scene" if cutoff == chosen else "for comparison"
        yield Row(name=f"restitution, {pair.name} pair, attraction {cutoff}", value=value, note=note)


def _step_rows(scene: Scene, derived: Derived) -> Iterator[Row]:
    plan = derived.plan
    yield Row(name="time step", value=plan.dt, unit="s", note="duration/steps, at most dt_fraction t_c")
    yield Row(name="steps", value=plan.steps, note="a common multiple of samples and frames")
    yield Row(name="duration", value=scene.duration, unit="s")
    yield Row(name="sample every", value=plan.sample_every, unit="steps")
    yield Row(name="frame every", value=plan.frame_every, unit="steps")
    yield Row(name="steps per contact", value=derived.steps_per_contact, note="time scale of the smallest pair / dt")
    note = f"2/omega (sqrt(1 + zeta^2) - zeta), set by the {derived.stability.part}"
    yield Row(name="stability limit", value=derived.stability.dt, unit="s", note=note)
    yield Row(name="stability margin", value=derived.stability_margin, note="limit / time step")


def _drive_rows(derived: Derived) -> Iterator[Row]:
    if derived.inertial_number is not None:
        side = "quasistatic" if derived.inertial_number < QUASISTATIC else "rate matters"
        note = f"eps'_max sqrt(m/p), eps'_max = pi eps_f/(2 T sqrt(1 - eps_f)); {side}"
        yield Row(name="inertial number, peak", value=derived.inertial_number, note=note)
    for wall in derived.walls:
        yield from _wall_rows(wall)


def _wall_rows(wall: WallScales) -> Iterator[Row]:
    note = f"2 pi sqrt(M/(n k_n)) with about n = {wall.contacts:.0f} contacts"
    yield Row(name=f'period of the wall "{wall.name}"', value=wall.period, unit="s", note=note)
    if wall.damping_time is not None:
        yield Row(name=f'damping time of the wall "{wall.name}"', value=wall.damping_time, unit="s", note="M/gamma")
    shares = {"inertia": wall.inertia_share, "damping": wall.damping_share}
    for name, share in shares.items():
        if share is not None:
            note = "of p z, while the sample gives way sideways as fast as it is compressed"
            yield Row(name=f'{name} of the wall "{wall.name}"', value=share, note=note)


def _effect_rows(scene: Scene, system: System | None) -> Iterator[Row]:
    for effect in effects(scene, system):
        note = f"{effect.place}: {effect.reason}; {effect.brings}"
        yield Row(name=effect.name, value="on" if effect.on else "off", note=note)


