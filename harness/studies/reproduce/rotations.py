"""`rotations`: how discs turn in the biaxial box, where, and what stress goes with it.

At the talk's four strains, of the displacements u and rotations theta since the start, in cells of a few diameters:

    shear      deviator of the symmetric part of du/dx; the band: cells that shear most and carry half of it
    W          (du_y/dx - du_x/dy)/2, the rotation of the sample as a continuum
    sigma_A    (sigma_xy - sigma_yx)/2, antisymmetric stress, counter-clockwise

Summed over all contacts of a disc, sigma_A is the couple on it: 2 V sigma_A = sum_p w^p I^p dw^p/dt up to its sign. So
averages over whole discs have an antisymmetric part only as far as discs are accelerated, and none in equilibrium;
averages that cut through discs (coarse graining with a width of a diameter, I. Goldhirsch, Granular Matter 12, 239
(2010)) have one at rest, too. Both are measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from msgspec.structs import replace

from harness.scene.laws import elastic_stiffness
from harness.studies.reproduce.boxes import (
    BoxRun,
    base_scene,
    box_checks,
    measure_box,
    number_over_packings,
    rate_points,
    rate_words,
    rerun_of,
    shipped,
    varied,
)
from harness.studies.reproduce.protocol import (
    Ask,
    Case,
    Chart,
    Declared,
    DiscPicture,
    Line,
    Panel,
    Picture,
    Result,
    Row,
    Study,
)
from harness.studies.reproduce.rows import larger_than, shown
from harness.studies.reproduce.runs import Made, by_engine, engines_of, run_cases, study_runs, unsupported
from harness.studies.verdict import Check
from postproc.average import average
from postproc.macro.tensors import principal
from postproc.snapshot import Snapshot

FILES = {"quick": shipped("biaxial_quick"), "paper": shipped("biaxial")}
COUNTS = {"quick": 400, "paper": 1950}
DURATIONS = {"quick": (0.03, 0.06), "paper": (0.064, 0.128, 0.256)}
MAIN = 1
FRAMES = 100

STRAINS = (0.0, 0.011, 0.042, 0.091)
"""Axial strains of the talk's four pictures."""

CELL = 3.0
"""Side of a cell in mean diameters."""

WIDTH = 1.0
"""Width of the coarse graining in mean diameters: a Gaussian's standard deviation."""

TURN, IN_BAND = "rotation, rms", "rotation in the band over outside"
FOLLOWS, HALF = "rotation of the discs over that of the continuum", "part of the box that carries half of the shear"
WHOLE, CUT = "antisymmetric stress of whole discs, rms over p", "antisymmetric stress, coarse-grained, rms over p"
CUT_IN_BAND = "antisymmetric stress, coarse-grained, in the band over outside"
UNITS = {TURN: "deg", IN_BAND: "1", FOLLOWS: "1", HALF: "1", WHOLE: "1", CUT: "1", CUT_IN_BAND: "1"}
"""Measured at every strain but the first; p is the mean stress of the cells."""


def at(name: str, strain: float) -> str:
    """Return a number's name at a strain."""
    return f"{name}, at {100 * strain:.2g} %"


@dataclass(frozen=True, kw_only=True, eq=False)
class Shot:
    """One of the four states: frame, its axial strain, and of the discs u (N, 2), m, rotation (N,), energy (N,), J."""

    frame: Snapshot
    strain: float
    displacement: np.ndarray
    rotation: np.ndarray
    energy: np.ndarray


@dataclass(frozen=True, kw_only=True, eq=False)
class RotationRun(BoxRun):
    """A run of a box with the four states."""

    shots: tuple[Shot, ...]


def cases(ask: Ask) -> list[Case]:
    """Return the test at every rate, the main one first."""
    durations = DURATIONS[ask.size]
    return [_case(ask, t) for t in (durations[MAIN], *(t for k, t in enumerate(durations) if k != MAIN))]


def _case(ask: Ask, duration: float) -> Case:
    file, count = FILES[ask.size], COUNTS[ask.size]
    base = base_scene(file)
    scene = varied(
        base, file, duration=duration, particles=replace(base.particles, count=count),
        title=f"Rotations, mu = {base.contact.sliding.shear_friction:g}, T = {duration:g} s, {count} discs",
        outputs=replace(base.outputs, samples=500, frames=FRAMES, contacts=True, rotations=True),
    )
    return Case(name=f"T = {duration:g} s", scene=scene, file=file, packings=STUDY.packings(ask))


def run(ask: Ask) -> Result:
    """Run the test at all rates, and show where discs turn."""
    planned = cases(ask)
    main = planned[0]
    made = run_cases(ask, planned, measure)
    rates = [
        p for name in (TURN, CUT, WHOLE) for s in STRAINS[1:]
        for p in rate_points(made, planned, at(name, s), quantity=at(name, s), unit=UNITS[name])
    ]
    judged = {at(name, s): UNITS[name] for name in (TURN, FOLLOWS, CUT) for s in STRAINS[1:]}
    rerun = rerun_of("rotations", ask)
    return Result(
        rows=tuple(_rows(made, main.name)), rates=tuple(rates), rate_words=_rate_words(rates),
        checks=(*_claims(made, main.name), *box_checks(made, [main], judged, rerun)), runs=study_runs(made),
        pictures=_pictures(made, main.name), words=_words(made, main.name), unsupported=unsupported(made),
    )


# --- one run -------------------------------------------------------------------------------------


def measure(case: Case, trajectory, system) -> RotationRun:
    """Measure a run at its walls, and the four states."""
    box = measure_box(case, trajectory, system)
    frames = trajectory.frames
    kn, kt = (elastic_stiffness(law) for law in (system.normal, system.sliding))
    numbers = dict(box.numbers)
    shots = []
    for strain, frame in _nearest(frames):
        shots.append(_shot(frame, frames[0], strain, kn, kt))
        if frame is not frames[0]:
            wanted = min(STRAINS, key=lambda s, e=strain: abs(s - e))
            numbers |= {at(name, wanted): v for name, v in local_numbers(frame, frames[0]).items()}
    return RotationRun(**{**vars(box), "numbers": numbers}, shots=tuple(shots))


def _nearest(frames: Sequence[Snapshot]) -> list[tuple[float, Snapshot]]:
    """Return the frames nearest to the four strains, with their own."""
    height = np.array([np.ptp(f.box[1]) for f in frames])
    strain = 1.0 - height / height[0]
    return [(float(strain[k]), frames[k]) for k in (int(np.argmin(np.abs(strain - s))) for s in STRAINS)]


def _shot(frame: Snapshot, first: Snapshot, strain: float, kn: float, kt: float) -> Shot:
    p, before = frame.particles, first.particles
    found = average(
        frame, cells="particles", fields=["normal_elastic_energy", "tangential_elastic_energy"], kn=kn, kt=kt
    )
    return Shot(
        frame=frame, strain=strain, displacement=p.vector("x", "y") - before.vector("x", "y"),
        rotation=p["rotation"] - before["rotation"],
        energy=found["normal_elastic_energy"] + found["tangential_elastic_energy"],
    )


def local_numbers(frame: Snapshot, first: Snapshot) -> dict[str, float]:
    """Return the numbers of one state by the names of UNITS."""
    diameter = 2.0 * float(frame.particles["radius"].mean())
    shape = [max(2, round(float(length) / (CELL * diameter))) for length in np.ptp(frame.box, axis=1)]
    cells = average(
        frame, cells=f"grid:{shape[0]}x{shape[1]}", reference=first,
        fields=["rotation", "displacement_gradient", "stress_antisymmetric", "stress_isotropic"],
    )
    points = average(
        frame, cells=f"points:{2 * shape[0]}x{2 * shape[1]}", kernel="gaussian", width=WIDTH * diameter,
        fields=["stress_antisymmetric"],
    )
    H, theta = cells["displacement_gradient"], cells["rotation"]
    band, p = band_cells(principal(H).deviator), float(cells["stress_isotropic"].mean())
    W = 0.5 * (H[:, 1, 0] - H[:, 0, 1])
    whole, cut = cells["stress_antisymmetric"], points["stress_antisymmetric"]
    cut_in_band = band[_cells_of(points, frame, shape)]
    turned = frame.particles["rotation"] - first.particles["rotation"]
    return {
        TURN: float(np.degrees(rms(turned))), HALF: float(band.mean()),
        IN_BAND: _over(float(np.abs(theta[band]).mean()), float(np.abs(theta[~band]).mean())),
        FOLLOWS: float(theta @ W / (W @ W)), WHOLE: rms(whole) / p, CUT: rms(cut) / p,
        CUT_IN_BAND: _over(rms(cut[cut_in_band]), rms(cut[~cut_in_band])),
    }


def band_cells(shear: np.ndarray) -> np.ndarray:
    """Return a mask (K,) of the fewest cells that carry half of the shear (K,), all cells of one size."""
    order = np.argsort(-shear, kind="stable")
    carried = np.cumsum(shear[order]) / shear.sum()
    band = np.zeros(len(shear), dtype=bool)
    band[order[: int(np.searchsorted(carried, 0.5)) + 1]] = True
    return band


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def _over(inside: float, outside: float) -> float:
    """Return the ratio, NaN where nothing is outside."""
    return inside / outside if outside else float("nan")


def _cells_of(points, frame: Snapshot, shape: Sequence[int]) -> np.ndarray:
    """Return the cell (row of the grid's, x slowest) in which each point lies."""
    low, length = np.asarray(frame.box)[:, 0], np.ptp(frame.box, axis=1)
    x = np.stack([points.coordinates[a].values for a in "xy"], axis=1)
    i = np.clip(((x - low) / length * shape).astype(int), 0, np.array(shape) - 1)
    return i[:, 0] * shape[1] + i[:, 1]


# --- rows and claims -----------------------------------------------------------------------------


def _rows(made: Sequence[Made], case: str) -> list[Row]:
    return [
        shown(at(name, s), unit, ours, "the talk shows pictures and prints no number")
        for name, unit in UNITS.items() for s in STRAINS[1:]
        for ours in number_over_packings(made, case, at(name, s)).values()
    ]


def _claims(made: Sequence[Made], case: str) -> list[Check]:
    """The talk's words: discs turn in the shear bands, and the stress has an antisymmetric part there."""
    return [
        larger_than(1.0, ours, quantity=at(name, s), against="talk: 'rotations' in shear bands" if name == IN_BAND
                    else "talk: 'anti-symmetric (!) stress' in shear bands")
        for name in (IN_BAND, CUT_IN_BAND) for s in STRAINS[1:]
        for ours in number_over_packings(made, case, at(name, s)).values()
    ]


# --- pictures and words --------------------------------------------------------------------------


def _pictures(made: Sequence[Made], case: str) -> tuple[Picture, ...]:
    engines = engines_of(made)
    shots = next((of[0].shots for of in by_engine(made, case).values() if 0 in of), ())
    if not shots:
        return ()
    return (
        _rotation_picture(shots, engines[0]), _displacement_picture(shots, engines[0]),
        _energy_picture(shots, engines[0]),
        *(_growth(made, case, names, engines) for names in ((TURN,), (WHOLE, CUT))),
    )


def _title(shot: Shot) -> str:
    return f"ε_zz = {100 * shot.strain:.1f} %"


def _rotation_picture(shots: Sequence[Shot], engine: str) -> DiscPicture:
    """Rotations over the strain that has turned the discs, so that one scale suits all."""
    per_strain = [np.degrees(s.rotation) / (100 * s.strain) if s.strain else np.zeros(len(s.rotation)) for s in shots]
    limit = float(np.percentile(np.abs(np.concatenate(per_strain[1:])), 97))
    return DiscPicture(
        name="rotation", label="rotation over axial strain (degrees per %)", limit=limit,
        panels=tuple(Panel(title=_title(s), frame=s.frame, colour=v) for s, v in zip(shots, per_strain, strict=True)),
        caption=f"Rotation of each disc since the start, red counter-clockwise ({engine}, first packing); at 0 % "
        "nothing has turned.",
    )


def _displacement_picture(shots: Sequence[Shot], engine: str) -> DiscPicture:
    return DiscPicture(
        name="displacement", panels=tuple(Panel(title=_title(s), frame=s.frame, arrows=s.displacement) for s in shots),
        caption=f"Displacement of each disc since the start, in real length ({engine}, first packing).",
    )


def _energy_picture(shots: Sequence[Shot], engine: str) -> DiscPicture:
    return DiscPicture(
        name="energy", label="potential energy over the mean", limit=4.0, diverging=False,
        panels=tuple(Panel(title=_title(s), frame=s.frame, colour=s.energy / s.energy.mean()) for s in shots),
        caption="Potential energy of the contacts of each disc, normal and tangential springs "
        f"({engine}, first packing).",
    )


def _growth(made: Sequence[Made], case: str, names: Sequence[str], engines: Sequence[str]) -> Chart:
    lines = []
    for name in names:
        for e in engines:
            found = [number_over_packings(made, case, at(name, s)).get(e) for s in STRAINS[1:]]
            if all(m is not None for m in found):
                lines.append(Line(
                    name=f"{name}, {e}" if len(names) > 1 else e, look="points", x=100 * np.array(STRAINS[1:]),
                    y=np.array([m.value for m in found]),
                    error=np.array([np.nan if m.error is None else m.error for m in found]),
                ))
    turning = TURN in names
    return Chart(
        name="turning" if turning else "antisymmetric", x="axial strain (%)", lines=tuple(lines), log_y=not turning,
        y="rms rotation (degrees)" if turning else "rms antisymmetric stress over mean stress",
        caption="Rotation of the discs." if turning else
        "Antisymmetric stress: averaged over whole discs it is the couple that accelerates them; coarse-grained with a "
        "width of one diameter it is also there at rest.",
    )


def _words(made: Sequence[Made], case: str) -> tuple[str, ...]:
    last = STRAINS[-1]
    found = {name: [m.value for m in number_over_packings(made, case, at(name, last)).values()] for name in UNITS}
    if not all(found.values()):
        return ("No run was completed.",)

    def mean(name: str) -> float:
        return float(np.mean(found[name]))

    return (
        f"At {100 * last:.2g} % strain, means over engines: {100 * mean(HALF):.0f} % of the box carry half of its "
        f"shear. There discs have turned {mean(IN_BAND):.1f} times as far as outside, and cell by cell "
        f"{mean(FOLLOWS):.2f} times as far as the continuum between them.",
        f"The antisymmetric stress of averages over whole discs is {mean(WHOLE):.1g} of the mean stress: it is the "
        "couple that accelerates them, and nothing at rest. Coarse-grained with a width of one diameter it is "
        f"{mean(CUT):.1g} of the mean stress, {mean(CUT_IN_BAND):.1f} times as large in the band as outside. Which of "
        "the two the talk shows with an exclamation mark it does not say.",
    )


def _rate_words(points) -> str:
    parts = {name: [p for p in points if p.quantity.startswith(name)] for name in (TURN, CUT, WHOLE)}
    said = [f"{name}: {rate_words(of, what='value')}" for name, of in parts.items() if of]
    return " ".join(said)


STUDY = Study(
    name="rotations",
    title="Rotations and antisymmetric stress in the shear bands of the biaxial box",
    claim="pictures of displacement, rotation and potential energy at 0, 1.1, 4.2 and 9.1 % strain: discs turn in the "
    "shear bands, and the local stress there is 'anti-symmetric (!)'",
    source="S. Luding, 'Shear banding in granular materials', pages 'Bi-axial box', 'Bi-axial box rotations', 'Micro "
    "informations: shear bands' and 'Rotations (local)'",
    sizes={
        "quick": Declared(says="400 discs, mu = 0.5, p_x = 100 N/m, T = 0.06 s", packings=3),
        "paper": Declared(says="1950 discs, mu = 0.5, p_x = 100 N/m, T = 0.128 s", packings=3),
    },
    engines=("lammps", "liggghts", "kernel:talk"),
    values=(),
    run=run,
    cases=cases,
)
