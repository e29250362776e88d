"""The contact law from curves: fits with known answers, error bars that cover, files refused, codes that answer."""

from dataclasses import replace

import numpy as np
import pytest

from harness.engines.registry import ENGINES
from harness.errors import InputError
from harness.scene.load import load_scene
from harness.studies.laws.drive import Driver
from harness.studies.reproduce.contact import SPHERES, STUDY
from harness.studies.reproduce.contact.axes import axes_rows
from harness.studies.reproduce.contact.back import Indenter, law_of
from harness.studies.reproduce.contact.curves import Cycle, read_measurements
from harness.studies.reproduce.contact.fit import fit_cycle, fit_line, law_force, propagated, pull_off_slope
from harness.studies.reproduce.contact.loads import answers, back_rows, law_checks, load_rows, refused
from harness.studies.reproduce.contact.scene import write_fitted_scene
from harness.studies.reproduce.contact.synthetic import Truth, coverages
from harness.studies.reproduce.protocol import Ask
from reference.analytic.hysteretic_collision import ConstantUnloading

TRUTH = Truth()
HEADER = "displacement (nm),force (nN)\n"


def exact(truth=TRUTH):
    return replace(truth, noise=0.0).cycle(0)


def test_the_model_is_the_law():
    law = ConstantUnloading(loading=20.0, unloading=60.0, adhesion=30.0, reduced_mass=1.0)
    d = np.linspace(-2e-9, 10e-9, 400)
    back = law_force(d, np.zeros(400, dtype=bool), 10e-9, 20.0, 60.0, 30.0, 0.0)
    assert back == pytest.approx(law.force(d, 10e-9), abs=1e-20)
    assert law_force(d, np.ones(400, dtype=bool), 10e-9, 20.0, 60.0, 30.0, 0.0) == pytest.approx(
        20.0 * np.maximum(d, 0), abs=1e-20)
    assert pull_off_slope(20.0, 60.0, 30.0) == pytest.approx(-law.largest_attraction(1.0) / 20.0)


def test_without_noise_the_fit_is_exact():
    fit = fit_cycle(exact(), draws=0)
    assert fit.values == pytest.approx([20.0, 60.0, 30.0, 3e-9], rel=1e-8)
    assert fit.adhesive
    assert fit.largest == pytest.approx(TRUTH.largest, rel=1e-8)


def test_error_bars_cover_the_truth():
    """Of both kinds; a tenth of the noise promised would be seen at once."""
    for c in coverages(TRUTH, curves=150, bootstraps=40, draws=60):
        assert abs(c.share - 0.95) <= c.room
    fits = [fit_cycle(TRUTH.cycle(k), draws=0) for k in range(100)]
    halved = [np.abs(f.values[:3] - TRUTH.stiffnesses) <= 1.96 * 0.5 * f.errors[:3] for f in fits]
    assert abs(np.mean(halved) - 0.95) > 4 * np.sqrt(0.95 * 0.05 / 100)


def test_covariance_and_bootstrap_agree():
    fit = fit_cycle(TRUTH.cycle(3), draws=300)
    assert fit.bootstrap_errors == pytest.approx(fit.errors, rel=0.2)
    assert fit.noise == pytest.approx(TRUTH.noise, rel=0.15)


def test_given_errors_count():
    """Noise of a hundredth where the force is large, and said so: k_2 is known that much better."""
    cycle = exact()
    error = np.where(np.abs(cycle.force) > 5e-8, 1e-10, 1e-8)
    noisy = cycle.force + error * np.random.default_rng(1).normal(size=len(error))
    told, untold = (fit_cycle(Cycle(displacement=cycle.displacement, force=noisy, error=e), draws=0)
                    for e in (error, None))
    assert told.errors[1] < 0.2 * untold.errors[1]
    assert np.abs(told.values[:3] - TRUTH.stiffnesses).max() < 5 * told.errors[:3].max()


def test_a_jump_off_leaves_the_adhesion_unknown():
    """Without a point on the adhesive branch k_c has no error bar."""
    cycle = exact()
    deepest = int(np.argmin(cycle.force))
    jump = Cycle(displacement=cycle.displacement[: deepest - 2], force=cycle.force[: deepest - 2], error=None)
    fit = fit_cycle(jump, draws=0)
    assert not fit.adhesive
    assert np.isnan(fit.errors[2])
    assert fit.values[:2] == pytest.approx([20.0, 60.0], rel=1e-6)


def test_propagation():
    fit = fit_cycle(TRUTH.cycle(5), draws=200)
    value, error = propagated(fit, pull_off_slope)
    drawn = [pull_off_slope(*k) for k in fit.bootstrap[:, :3]]
    assert value == pytest.approx(pull_off_slope(*fit.values[:3]))
    assert error == pytest.approx(np.std(drawn), rel=0.25)


# --- files ---------------------------------------------------------------------------------------


def write(tmp_path, text):
    path = tmp_path / "curve.csv"
    path.write_text(text)
    return path


def rows_of(cycle):
    return "\n".join(f"{1e9 * x:.9g},{1e9 * f:.9g}" for x, f in zip(cycle.displacement, cycle.force, strict=True))


def test_a_file_is_read_in_its_units(tmp_path):
    found = read_measurements(write(tmp_path, f"# a comment\ndisplacement (nm), force (nN)\n{rows_of(exact())}\n"))
    assert fit_cycle(found.cycle(), draws=0).values == pytest.approx([20.0, 60.0, 30.0, 3e-9], rel=1e-6)
    line = read_measurements(write(tmp_path, "load (mN/m),pull-off (mN/m)\n0.1,0.07\n0.2,0.14\n0.4,0.28\n0.8,0.56\n"))
    assert fit_line(line).slope == pytest.approx(0.7)
    assert line.x[0] == pytest.approx(1e-4)
    line = read_measurements(write(tmp_path, "force (nN),hysteresis (nm)\n50,2\n100,4\n150,6\n200,8\n"))
    assert fit_line(line).slope == pytest.approx(0.04)


@pytest.mark.parametrize(("text", "named"), [
    ("", "header"), ("force (nN)\n1\n", "header"), ("displacement (nm),force (furlong)\n1,2\n", "furlong"),
    ("displacement (nm),force (nN)\n1,x\n", "line 2"), ("displacement (nm),force (nN)\n1\n", "line 2"),
    ("displacement (nm),force (nN)\n" + "".join(f"{k},{k}\n" for k in range(20)), "a way in and a way back"),
    ("load (nN),pull-off (mN/m)\n1,2\n", "units of one kind"),
    ("load (nN),pull-off (nN)\n1,2\n2,3\n", "at least 4 points"),
    ("displacement (nm),force (nN),error (nN)\n1,2,0\n2,3,1\n", "an error > 0"),
    ("displacement (nm),force (nN),error (nm)\n1,2,1\n", "the error in a unit of force"),
    ("displacement (nm),force (nN)\n1,nan\n", "line 2"),
    ("displacement (nm),force (nN),colour (red)\n1,2,3\n", "colour"),
])
def test_wrong_files_are_refused_in_one_line(tmp_path, text, named):
    with pytest.raises(InputError) as error:
        read_measurements(write(tmp_path, text))
    assert named in str(error.value)
    assert "\n" not in str(error.value)
    assert "curve.csv" in str(error.value)


@pytest.mark.parametrize("force", [lambda f: -f, lambda f: 0 * f, lambda f: f[::-1].copy() * 0 - 1e-9])
def test_curves_that_are_no_contact_are_refused(force):
    cycle = exact()
    with pytest.raises(InputError, match="rises on the way in"):
        fit_cycle(Cycle(displacement=cycle.displacement, force=force(cycle.force), error=None), draws=0)


def test_what_is_asked_wrongly_is_refused_before_anything_is_made(tmp_path):
    ask = Ask(size="quick", engines=(), out=tmp_path / "out")
    STUDY.check(ask)
    with pytest.raises(InputError, match="--packings: expected nothing, as contact has no packings, got 3"):
        STUDY.check(replace(ask, packings=3))
    cycle = exact()
    flat = replace(cycle, force=np.zeros_like(cycle.force))
    with pytest.raises(InputError, match=r"curve\.csv: expected a force that rises on the way in, got 0 N at most"):
        STUDY.check(replace(ask, measurements=write(tmp_path, HEADER + rows_of(flat))))
    assert not (tmp_path / "out").exists()


def test_the_transcript_decides_nothing():
    assert {row["decides"] for row in axes_rows()} == {"nothing"}
    assert not STUDY.values


# --- scene and codes -----------------------------------------------------------------------------


def test_the_fitted_scene_is_one(tmp_path):
    fit = fit_cycle(TRUTH.cycle(1), draws=0)
    scene = load_scene(write_fitted_scene(tmp_path / "fitted.toml", fit, SPHERES, "a test"))
    law = scene.contact.normal
    assert [law.loading_stiffness, law.unloading_stiffness, law.adhesion_stiffness] == fit.values[:3].tolist()
    pair = ConstantUnloading(loading=law.loading_stiffness, unloading=law.unloading_stiffness,
                             adhesion=law.adhesion_stiffness, reduced_mass=SPHERES.mass / 2)
    speed = scene.bodies[0].velocity[0] - scene.bodies[1].velocity[0]
    assert pair.largest_overlap(speed) == pytest.approx(fit.largest)


@pytest.fixture
def fitted():
    return fit_cycle(exact(), draws=0)


def answered(fitted, tmp_path, names, told=None):
    indenter = Indenter(spheres=SPHERES, largest=fitted.largest)
    driver = Driver(root=tmp_path / "runs", time_limit=60.0, workers=1)
    law = law_of(*(fitted.values[:3] if told is None else told))
    return answers(law, indenter, [ENGINES[n] for n in names], driver)


def test_the_law_is_measured_back(fitted, tmp_path):
    found = answered(fitted, tmp_path, ["lammps", "kernel:talk"])
    assert list(refused(found)) == ["lammps"]
    assert {r.verdict for r in (*back_rows(found, fitted), *load_rows(found, fitted))} == {"agrees"}
    assert len(back_rows(found, fitted)) == 3
    assert [c.verdict for c in law_checks(found, fitted, lambda *e: "again")] == ["agrees"]


@pytest.mark.parametrize("wrong", [(20.001, 60.0, 30.0), (20.0, 60.01, 30.0), (20.0, 60.0, 30.001)])
def test_a_wrong_stiffness_is_seen(fitted, tmp_path, wrong):
    found = answered(fitted, tmp_path, ["kernel:talk"], told=wrong)
    assert "differs" in {r.verdict for r in back_rows(found, fitted)}
    assert [c.verdict for c in law_checks(found, fitted, lambda *e: "again")] == ["differs"]


def test_nothing_touches_at_the_start():
    indenter = Indenter(spheres=SPHERES, largest=1e-8)
    assert indenter.overlap[0] < 0
    assert indenter.overlap.max() == pytest.approx(1e-8)
