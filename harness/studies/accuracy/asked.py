"""What a user asks for: knobs that the scene has, rungs that make a ladder, a quantity that is computed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.errors import InputError
from harness.scene.describe import nearest
from harness.scene.laws import turning
from harness.scene.model import Biaxial, Couette, Free, Scene
from harness.studies.accuracy.bulk_quantities import BULK
from harness.studies.accuracy.turn import why_not_stiffened
from harness.studies.compare.curves import SMOOTHED

FEWEST, MOST = 2, 40
"""Rungs of a ladder: of one there is nothing to fit, of more nobody asks."""

ALL = "all"
"""As a knob: every one that tends to a limit."""


@dataclass(frozen=True, kw_only=True)
class Knob:
    """One thing that users turn to save time.

    value: what its numbers are. largest: beyond it they mean nothing. ladder: the usual rungs, cheapest first, in units
    of what `own` says of a scene. whole: numbers are whole. x: what tends to 0 as the knob is turned up, and expected:
    the order that theory gives the error in x. words: its values are laws by number, not numbers.
    """

    name: str
    value: str
    ladder: tuple[float, ...]
    largest: float
    own: Callable[[Scene], float] = lambda _: 1.0
    whole: bool = False
    x: Callable[[float], float] = lambda value: value
    expected: float = 1.0
    words: bool = False


FREE_STEP = (0.64, 0.32, 0.16, 0.08, 0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125)


def _inverse(value: float) -> float:
    return 1.0 / value


def _dt(*ladder: float) -> Knob:
    """First order: dashpots see half-step velocities, contacts begin and end between steps (measured on impacts)."""
    return Knob(name="dt", value="dt_fraction", largest=10.0, ladder=ladder, own=lambda s: s.numerics.dt_fraction)


def _stiffness(*ladder: float) -> Knob:
    """First order in 1/k: overlaps are p/k."""
    return Knob(name="stiffness", value="stiffness over the scene's", largest=1e6, ladder=ladder, x=_inverse)


def _rate(*ladder: float) -> Knob:
    """First order: mu = mu_s + a I (F. da Cruz et al., Phys. Rev. E 72, 021309 (2005))."""
    return Knob(name="rate", value="rate over the scene's", largest=1e6, ladder=ladder)


LAW = Knob(name="law", value="law", ladder=(), largest=0.0, words=True)

BOX = {
    "dt": _dt(8.0, 4.0, 2.0, 1.0, 0.5),
    "stiffness": _stiffness(1 / 64, 1 / 16, 1 / 4, 1.0),
    "rate": _rate(8.0, 4.0, 2.0, 1.0),
    "size": Knob(  # first order in 1/side: layers at walls are a few particles thick
        name="size", value="particles", largest=1e6, ladder=(0.25, 0.5, 1.0), whole=True,
        own=lambda s: float(s.particles.count or 0), x=lambda n: n**-0.5,
    ),
    "width": Knob(  # second order: a mean over w about a smooth top is lower by w^2 y''/24
        name="width", value="strain averaged over", largest=1.0, ladder=(8.0, 4.0, 2.0, 1.0, 0.5),
        own=lambda _: SMOOTHED, expected=2.0,
    ),
}
RING = {
    "dt": _dt(4.0, 2.0, 1.0),
    "stiffness": _stiffness(1 / 16, 1 / 4, 1.0),
    "rate": _rate(4.0, 2.0, 1.0),
    "width": Knob(
        name="width", value="cells", largest=1000.0, ladder=(0.25, 0.5, 1.0, 2.0), whole=True, x=_inverse,
        own=lambda s: float(s.compare.cells), expected=2.0,
    ),
}


def _scheme(steps: Knob, *, own: bool = True) -> Knob:
    """The same steps; the engines are then the kernel's conventions."""
    more = {"own": steps.own} if own else {}
    return Knob(name="scheme", value=steps.value, largest=steps.largest, ladder=steps.ladder, **more)


FREE_DT = Knob(name="dt", value="dt_fraction", largest=10.0, ladder=FREE_STEP)

KNOBS: dict[type, dict[str, Knob]] = {
    Free: {"dt": FREE_DT, "scheme": _scheme(FREE_DT, own=False)},
    Biaxial: BOX | {"scheme": _scheme(BOX["dt"]), "law": LAW},
    Couette: RING | {"scheme": _scheme(RING["dt"]), "law": LAW},
}
"""By kind of scene."""

USUAL: dict[type, tuple[str, ...]] = {
    Free: ("dt",), Biaxial: ("dt", "stiffness", "rate", "size", "width"), Couette: ("dt", "stiffness", "rate"),
}
"""What is turned unless the user says otherwise."""

LIMITED = ("dt", "stiffness", "rate", "size", "width")
"""Knobs that `all` means: those whose errors tend to nothing."""

WITHOUT = {
    (Free, "stiffness"): "softer bodies part later; set it in a copy of the scene and compare the two",
    (Free, "rate"): "nothing drives free bodies", (Free, "size"): "every body of it was placed by hand",
    (Free, "width"): "nothing is averaged there", (Free, "law"): "set it in a copy of the scene and compare the two",
    (Couette, "size"): "the density decides on a band, and another number of discs has another density",
}
"""Why a kind of scene lacks a knob that others have."""

QUANTITIES: dict[type, tuple[str, ...]] = {
    Free: ("exit", "velocity", "spin"), **{kind: tuple(b.name for b in of) for kind, of in BULK.items()},
}
"""What errors are told of, by kind of scene; the first is the usual one."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """A checked request for one knob. values: of the knob, cheapest first."""

    knob: Knob
    values: tuple[float, ...]
    quantity: str

    @property
    def x(self) -> tuple[float, ...]:
        """What tends to 0, by rung."""
        return tuple(self.knob.x(v) for v in self.values)


def asked(scene: Scene, file: Path, *, knob: str | None, ladder: Sequence[float] | None, quantity: str | None) -> Asked:
    """Return what is to be done with one knob. Raises InputError for what this scene does not have."""
    (one,) = asked_all(scene, file, knob=knob, ladder=ladder, quantity=quantity)
    return one


def asked_all(
    scene: Scene, file: Path, *, knob: str | None, ladder: Sequence[float] | None, quantity: str | None
) -> tuple[Asked, ...]:
    """Return what is to be done with each knob of a list, "dt,rate", or of `all`. Raises InputError."""
    knobs = _knobs(scene, file, knob)
    if ladder is not None and (len(knobs) > 1 or knobs[0].words):
        raise InputError(
            file="--ladder", expected="one knob whose values are numbers", got=", ".join(k.name for k in knobs),
            fix="name one --knob with it",
        )
    about = _quantity(scene, quantity)
    return tuple(Asked(knob=k, values=_rungs(scene, k, ladder), quantity=about) for k in knobs)


def _knobs(scene: Scene, file: Path, names: str | None) -> tuple[Knob, ...]:
    knobs = KNOBS.get(type(scene), {})
    if not knobs:
        raise InputError(
            file=file, place="kind", expected=f"a kind of scene with a ladder ({', '.join(map(_kind, KNOBS))})",
            got=f'"{_kind(type(scene))}"',
        )
    if scene.contact.between:
        raise InputError(
            file=file, place="contact.between", expected="one set of numbers for all contacts, which the study turns",
            got="numbers by pair of materials", fix="measure a scene with the numbers of the stiffest pair for all",
        )
    lacking = _lacking(scene)
    if names is None or names == ALL:
        wanted = USUAL[type(scene)] if names is None else [n for n in LIMITED if n in knobs]
        wanted = [n for n in wanted if n not in lacking]
    else:
        wanted = list(dict.fromkeys(n for n in names.split(",") if n)) or [""]
    for name in wanted:
        _require_knob(scene, name, knobs, lacking)
    if isinstance(scene, Free) and len(wanted) > 1:
        raise InputError(file="--knob", expected="one knob of a free scene", got=",".join(wanted),
                         fix="dt and scheme are the same steps with other engines")
    return tuple(knobs[n] for n in wanted)


def _require_knob(scene: Scene, name: str, knobs: dict[str, Knob], lacking: dict[str, str]) -> None:
    if name in lacking:
        raise InputError(file="--knob", expected="a knob that the scene has", got=name, fix=lacking[name])
    if name in knobs:
        return
    known = {k for of in KNOBS.values() for k in of}
    why = WITHOUT.get((type(scene), name), "")
    fix = f"scenes of kind {_kind(type(scene))} do not have it{': ' * bool(why)}{why}" if name in known else nearest(
        name, list(knobs)
    )
    raise InputError(file="--knob", expected=f"one of {', '.join(knobs)}", got=name, fix=fix)


def _lacking(scene: Scene) -> dict[str, str]:
    """Return why this very scene lacks knobs that its kind has."""
    found = {}
    why = why_not_stiffened(scene.contact.normal)
    if why:
        found["stiffness"] = why
    if isinstance(scene, Biaxial) and scene.particles.packing is not None:
        found["size"] = "its particles come from a file"
    return found


def _rungs(scene: Scene, knob: Knob, ladder: Sequence[float] | None) -> tuple[float, ...]:
    if knob.words:
        return ()
    values = tuple(_usual(scene, knob)) if ladder is None else tuple(ladder)
    wrong = [v for v in values if not 0.0 < v <= knob.largest]
    if wrong:
        raise InputError(
            file="--ladder", expected=f"numbers > 0 and <= {knob.largest:g} ({knob.value})", got=f"{wrong[0]:g}"
        )
    whole = set(values) if isinstance(scene, Free) else {*values, knob.own(scene)}
    distinct = len(set(values))
    if distinct != len(values) or not FEWEST <= len(whole) <= MOST:
        got = "one rung" if distinct == 1 else f"{len(values)} rungs, {distinct} of them different"
        raise InputError(
            file="--ladder", expected=f"{FEWEST} to {MOST} different values of {knob.value}", got=got,
            fix="a slope needs several",
        )
    broken = [v for v in values if knob.whole and v != round(v)]
    if broken:
        raise InputError(file="--ladder", expected=f"whole numbers ({knob.value})", got=f"{broken[0]:g}")
    return tuple(sorted(whole, key=knob.x, reverse=True))


def _usual(scene: Scene, knob: Knob) -> list[float]:
    """Return the usual rungs in the knob's own numbers; of free scenes they are these already."""
    unit = 1.0 if isinstance(scene, Free) else knob.own(scene)
    values = [f * unit for f in knob.ladder]
    return [float(round(v)) for v in values] if knob.whole else values


def _quantity(scene: Scene, name: str | None) -> str:
    known = _quantities(scene)
    if name is not None and name not in known:
        raise InputError(
            file="--quantity", expected=f"one of {', '.join(known)}", got=name, fix=nearest(name, list(known))
        )
    return name or known[0]


def _quantities(scene: Scene) -> tuple[str, ...]:
    """Return the quantities of this very scene: without friction a box has no clear peak, without a plateau none."""
    known = QUANTITIES[type(scene)]
    if isinstance(scene, Biaxial):
        if scene.compare.plateau is None:
            known = tuple(n for n in known if n not in ("plateau_angle", "stress_ratio"))
        if not turning(scene.contact):
            known = tuple(n for n in known if n != "friction_angle")
    return known


def _kind(scene: type) -> str:
    return scene.__struct_config__.tag
