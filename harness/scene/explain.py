"""What `grainproof scene` says: the validated scene, what follows from it, which effects are on and why."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass

import msgspec

from harness.scene.derived import Derived, PairScales, WallScales, derive
from harness.scene.effects import effects
from harness.scene.fault import path_text, show
from harness.scene.grains import Pair
from harness.scene.materials import entry_of
from harness.scene.model import Couette, Free, Scene
from harness.scene.overlaps import initial_overlaps
from harness.scene.ring import area_fractions, rings_of
from harness.scene.system import System

NOT_AVAILABLE = "not available"
"""Value of what no closed form gives; the remark says why."""

RUN_TIME = "rough, on one core, with the engine's start-up"
"""Said of the time that an engine is expected to take."""

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
    """Return titled rows; `engines_expected` has the seconds that a run is expected to take, by engine.

    Without a system (see `harness.scene.resolve.known_system`) averages over particles are those of
    the declared distribution.
    """
    derived = derive(scene, system)
    sections = [
        ("scene", list(_scene_rows(scene))),
        ("particles", [*_particle_rows(derived), *_overlap_rows(scene, system)]),
        ("rings", list(_ring_rows(scene, derived)) if isinstance(scene, Couette) else []),
        ("contacts", [row for pair in derived.pairs for row in _pair_rows(scene, pair)]),
        ("time step", list(_step_rows(scene, derived))),
        ("drive", list(_drive_rows(derived))),
        ("effects", list(_effect_rows(scene, system))),
        ("expected run time", [time_row(e, s, RUN_TIME) for e, s in (engines_expected or {}).items()]),
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
    bodies, promised = data.pop("bodies", None), data.pop("expect", None) or {}
    yield from _leaves(data, [])
    yield from (Row(name="expect", value=i["name"], note=i["reason"]) for i in promised.get("invariants", ()))
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


def _ring_rows(scene: Couette, derived: Derived) -> Iterator[Row]:
    """Yield what the rings are, the densities in both ways of counting, and how fast the inner one shears."""
    rings, r = rings_of(scene), scene.rings
    diameter = 2 * derived.grains.pairs[1].reduced_radius * 2
    bounds = {"bare": "R_i < r < R_o", "free": "R_i + a_g < r < R_o - a_g, between the glued discs"}
    for ring in rings:
        yield Row(name=f"discs glued on the {ring.name} ring", value=len(ring.x))
    yield Row(name="gap", value=(r.outer_radius - r.inner_radius) / diameter, unit="mean diameters")
    for name, nu in area_fractions(scene).items():
        yield Row(name=f"area fraction, {name} annulus", value=nu, note=bounds[name])
    yield Row(name="speed of the inner ring", value=abs(r.omega) * r.inner_radius, unit="m/s", note="Omega R_i")
    turns = abs(r.omega) * scene.duration / (2 * math.pi)
    yield Row(name="turns of the inner ring", value=turns, note="while it runs; the preparation comes before")
    least = rings[0].x.shape[0] * derived.plan.dt * abs(r.omega) / (2 * math.pi)
    yield Row(name="glued discs that pass in a step", value=least, note="far below 1: no disc is jumped over")


def _overlap_rows(scene: Scene, system: System | None) -> Iterator[Row]:
    """Yield how many placed bodies touch at the start; a packing is relaxed first, so it has no such row."""
    if not isinstance(scene, Free) or system is None:
        return
    size = initial_overlaps(system).size
    note = f"largest {size.max():.4g} m; of bodies with bodies and walls" if len(size) else "nothing touches"
    yield Row(name="initial overlaps", value=len(size), note=note)


def _pair_rows(scene: Scene, scales: PairScales) -> Iterator[Row]:
    met, which = scales.met, f"{scales.pair.name} pair"
    yield Row(name=f"{met.time_name}, {which}", value=met.time_scale, unit="s", note=met.time_note)
    if scales.pair.materials is not None:
        yield Row(name=f"stiffness, {which}", value=met.stiffness, unit="N/m", note=_materials_note(scene, scales.pair))
    for fact in met.facts:
        what, _, details = fact.name.partition(", ")
        name = ", ".join(part for part in (what, which, details) if part)
        if fact.value is None:
            yield Row(name=name, value=NOT_AVAILABLE, note=fact.note)
        else:
            yield Row(name=name, value=fact.value, unit=fact.unit, note=fact.note)


def _materials_note(scene: Scene, pair: Pair) -> str:
    """Say where the numbers of two materials stand, and which bodies of theirs it is about."""
    k = entry_of(scene.contact, *pair.materials)
    place = "contact.normal" if k is None else f"contact.between[{k}]"
    return f"{place}; m* = {pair.reduced_mass:.4g} kg of the lightest ones"


def _step_rows(scene: Scene, derived: Derived) -> Iterator[Row]:
    plan, first = derived.plan, derived.pairs[0].pair
    fastest = "smallest" if first.materials is None else first.name
    yield Row(name="time step", value=plan.dt, unit="s", note="duration/steps, at most dt_fraction t_c")
    yield Row(name="steps", value=plan.steps, note="a common multiple of samples and frames")
    yield Row(name="duration", value=scene.duration, unit="s")
    yield Row(name="sample every", value=plan.sample_every, unit="steps")
    yield Row(name="frame every", value=plan.frame_every, unit="steps")
    yield Row(name="steps per contact", value=derived.steps_per_contact, note=f"time scale of the {fastest} pair / dt")
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


def time_row(name: str, seconds: float, note: str) -> Row:
    """Return a rough time in s, min or h, with two digits."""
    size, unit = next((s, u) for s, u in ((3600.0, "h"), (60.0, "min"), (0.0, "s")) if seconds >= s)
    return Row(name=name, value=float(f"{seconds / (size or 1.0):.2g}"), unit=unit, note=note)


def _effect_rows(scene: Scene, system: System | None) -> Iterator[Row]:
    for effect in effects(scene, system):
        note = f"{effect.place}: {effect.reason}; {effect.brings}"
        yield Row(name=effect.name, value="on" if effect.on else "off", note=note)


