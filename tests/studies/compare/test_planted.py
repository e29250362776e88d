"""Real runs: statistics alone find a planted difference, and where there is none they find none, at the declared rate.

The code under test is the kernel itself under another name, so that its kicks are others, with friction as it is or 2 %
larger.
"""

from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np
import pytest

from harness.engines.registry import find_engine
from harness.runs.pool import run_many
from harness.scene.load import load_scene
from harness.studies.compare import compare
from harness.studies.compare.biaxial_quantities import OneRun, biaxial_quantities
from harness.studies.compare.curves import biaxial_curves
from harness.studies.compare.pairs import Pair
from harness.studies.prepare import prepare
from harness.studies.statistics.family import Measured, Terms, judge_family
from harness.studies.statistics.kick import kicked
from postproc.trajectory import read_trajectory

QUICK = Path(__file__).parents[3] / "inputs" / "scenes" / "biaxial_quick.toml"
KERNEL = find_engine("kernel:lammps")


@dataclass(frozen=True)
class Disguised:
    """The kernel as a code called lammps, whose friction is `factor` times the scene's."""

    factor: float
    name: str = "lammps"
    startup_seconds: float = 0.4

    def probe(self):
        from dataclasses import replace

        probe = KERNEL.probe()
        return replace(probe, version=f"{probe.version} friction x {self.factor}")

    def _changed(self, system):
        friction = self.factor * system.sliding.shear_friction
        return system.with_(sliding=msgspec.structs.replace(system.sliding, shear_friction=friction))

    def render(self, system):
        return KERNEL.render(self._changed(system))

    def read(self, folder, system):
        return KERNEL.read(folder, self._changed(system))

    def changes(self, system):
        return ()

    def __getattr__(self, name):
        return getattr(KERNEL, name)


@pytest.fixture(scope="module")
def out(tmp_path_factory) -> Path:
    """One place for all, so that the kernel's own runs are made once."""
    return tmp_path_factory.mktemp("planted")


def verdicts(factor: float, out: Path) -> dict[str, list[str]]:
    comparison = compare(QUICK, (Disguised(factor), KERNEL), out, replicates=0)
    assert len(comparison.runs) == 2 * load_scene(QUICK).compare.replicates == len(comparison.completed)
    return {level: [c.verdict for c in comparison.checks if c.level == level] for level in ("L2", "L3")}


@pytest.mark.long
def test_two_per_cent_of_friction_are_found_by_the_shipped_number_of_replicates(out):
    found = verdicts(1.02, out)
    assert found["L3"].count("differs") >= 1
    assert "differs" in found["L2"]


@pytest.mark.long
def test_the_kernel_does_not_differ_from_itself(out):
    found = verdicts(1.0, out)
    assert "differs" not in found["L2"] + found["L3"]
    assert found["L3"].count("agrees") >= 10


PACKINGS, DISCS, DURATION = 32, 40, 0.04
"""Small boxes, so that there can be many: 64 runs of about 4 s."""


@pytest.fixture(scope="module")
def itself(tmp_path_factory) -> list[Measured]:
    """The kernel against itself, kicked, in many packings."""
    folder = tmp_path_factory.mktemp("itself")
    text = QUICK.read_text().replace("count = 200 ", f"count = {DISCS} ")
    text = text.replace("duration = 0.06 ", f"duration = {DURATION} ")
    assert text.count(f"= {DISCS} ") == text.count(f"= {DURATION} ") == 1
    file = folder / "small.toml"
    file.write_text(text)
    scene = load_scene(file)
    starts = prepare(scene, file, packings=PACKINGS, cache=folder / "packings")
    jobs = [(name, KERNEL, kicked(s.system, name)) for s in starts for name in ("a", "b")]
    done = run_many(jobs, folder / "runs", time_limit=600.0)
    assert all(d.outcome.status == "completed" for d in done)
    return biaxial_quantities(scene, [one_run(d, starts[k // 2], d.label) for k, d in enumerate(done)])


def one_run(done, start, name: str) -> OneRun:
    trajectory = read_trajectory(done.folder / "trajectory.h5")
    return OneRun(
        engine=name, replicate=start.number, curves=biaxial_curves(trajectory, start.system), trajectory=trajectory,
        system=start.system,
    )


def sides(measured: list[Measured], left: dict[int, str], right: dict[int, str]) -> list[Measured]:
    """Two sides of an imagined comparison: of which replicates, and whose runs of them."""
    return [
        Measured(quantity=m.quantity, unit=m.unit, scale=m.scale, values={
            name: {k: m.of(of).get(k, float("nan")) for k, of in side.items()}
            for name, side in (("a", left), ("b", right))
        })
        for m in measured
    ]


def other_seeds(rng: np.random.Generator, count: int):
    """Packings of its own for each side."""
    chosen = rng.choice(PACKINGS, 2 * count, replace=False)
    return dict.fromkeys(chosen[:count], "a"), dict.fromkeys(chosen[count:], "a")


def other_kicks(rng: np.random.Generator, count: int):
    """Packings that both share, exchanged at random: of equal codes any such draw is as likely as the real one."""
    chosen, swapped = rng.choice(PACKINGS, count, replace=False), rng.random(count) < 0.5
    left = {k: "b" if swap else "a" for k, swap in zip(chosen, swapped, strict=True)}
    return left, {k: "a" if name == "b" else "b" for k, name in left.items()}


DRAWS = 600
PAIR = Pair(left="a", right="b", kind="same_conventions")


def rates(measured: list[Measured], draw, count: int, *, paired: bool) -> tuple[float, float]:
    """How often any check of a family says that the kernel differs from itself, and how often a single one at 5 %."""
    rng, terms = np.random.default_rng(count), Terms(false_alarms=0.05, margin=0.05, paired=paired)
    families = [judge_family(sides(measured, *draw(rng, count)), [PAIR], terms) for _ in range(DRAWS)]
    singles = [j.tested.p <= 0.05 for family in families for j in family]
    return float(np.mean([any(j.verdict == "differs" for j in family) for family in families])), float(np.mean(singles))


@pytest.mark.long
@pytest.mark.parametrize("count", [4, 8])
def test_false_alarms_of_the_kernel_with_other_seeds(itself, count):
    """Declared: 5 %. Measured with 4 and 8 replicates a side: 4.1 and 4.4 % of checks, 3.3 and 2.5 % of families.

    Quantities of one run hang together, which Holm's procedure does not know: it is on the safe side.
    """
    family, single = rates(itself, other_seeds, count, paired=False)
    assert family <= 0.05 + 3.0 * np.sqrt(0.05 * 0.95 / DRAWS)
    assert single == pytest.approx(0.05, abs=0.015)


@pytest.mark.long
@pytest.mark.parametrize("count", [4, 8])
def test_false_alarms_of_the_kernel_with_other_kicks(itself, count):
    """Not every packing has parted: differences are small in most and large in some, where Student's t is careful.

    Measured: 0.3 and 0.6 % of checks, 0.3 and 0.2 % of families.
    """
    family, single = rates(itself, other_kicks, count, paired=True)
    assert family <= 0.05
    assert single <= 0.05
