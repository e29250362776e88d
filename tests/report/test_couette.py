"""The report of a ring: page, tables and picture with the same numbers, complete or not."""

import csv
import json
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from harness.report import couette
from harness.report.compare import check_report_places, write_report
from harness.report.ring_tables import number_page_rows, number_rows, profile_rows
from harness.runs.outcome import FileRecord, Outcome, host_facts
from harness.studies.compare.couette import judge_couette
from harness.studies.compare.study import Comparison, Run
from harness.studies.verdict import Rerun


@pytest.fixture
def comparison(ring):
    """comparison(runs by engine and packing, ring) of hand-made runs; None is a run that crashed."""

    def make(trajectories: dict, of=ring):
        starts = tuple(of.start(k) for k in range(1 + max(k for _, k in trajectories)))
        runs = tuple(
            Run(engine=e, packing=k, outcome=_outcome(of.system, e, t), folder=of.folder, trajectory=t)
            for (e, k), t in trajectories.items()
        )
        engines = list(dict.fromkeys(e for e, _ in trajectories))
        rerun = Rerun(scene_file=of.file, out=Path("out"), packings=None)
        checks, result = judge_couette(of.scene, starts, runs, engines, rerun)
        return Comparison(
            scene=of.scene, scene_file=of.file, starts=starts, runs=runs, checks=tuple(checks), result=result
        )

    return make


def _outcome(system, engine, trajectory) -> Outcome:
    now = datetime(2026, 1, 1, tzinfo=UTC)
    lost = trajectory is None
    return Outcome(
        status="crashed" if lost else "completed", reason="ended" if lost else "", scene_name="ring", engine=engine,
        engine_version="1", harness_version="1", host=host_facts(), system_digest="0", particles_digest="0",
        steps=system.steps, particles=len(system.particles), started=now, finished=now, load_average=0.0,
        cpu_seconds=1.0, wall_seconds=1.0, trajectory=None if lost else FileRecord(sha256="0", size=0),
    )


def test_page_tables_and_picture_are_written_and_agree(comparison, ring, tmp_path):
    made = comparison({("lammps", 0): ring.trajectory(seed=1), ("liggghts", 0): ring.trajectory(seed=2)})
    written = write_report(made, tmp_path / "out")
    page = written.page.read_text()
    for heading in ("Numbers of the steady state", "Torque", "Velocity", "Density", "Stress", "Equilibrium",
                    "Force chains", "Particle rotations"):
        assert f"{heading}</h2>" in page, heading
    assert written.picture.stat().st_size > 10_000
    data = json.loads(written.data.read_text())
    with open(tmp_path / "out" / "profiles.csv", newline="") as f:
        rows = list(csv.DictReader(f))
    assert len(rows) == 2 * 8 == len(data["tables"]["profiles"])
    assert {"v_phi (m/s)", "v_phi_error (m/s)", "volume_fraction", "stress_rphi (N/m)"} <= set(rows[0])
    assert float(rows[3]["v_phi (m/s)"]) == data["tables"]["profiles"][3]["v_phi (m/s)"]
    assert "NaN" not in written.data.read_text()


def test_the_page_says_on_top_whether_the_state_is_steady(comparison, ring, mutate, tmp_path):
    steady = comparison({("lammps", 0): ring.trajectory(seed=1), ("liggghts", 0): ring.trajectory(seed=2)})
    assert couette.lead(steady).startswith("The state is steady from")
    rng = np.random.default_rng(1)
    wild = mutate.series(
        ring.trajectory(seed=1), outer_torque=lambda t: t * (1 + 8 * rng.normal(size=len(t)))
    )
    open_ = comparison({("lammps", 0): wild, ("liggghts", 0): ring.trajectory(seed=2)})
    assert couette.lead(open_).startswith("That the state is steady was not shown")
    page = write_report(open_, tmp_path / "out").page.read_text()
    assert couette.lead(open_)[:40] in page
    assert "Numbers of the steady state" not in page
    assert f"Averages from {ring.scene.compare.steady_from:g} s on</h2>" in page


def test_numbers_stand_between_codes_on_page_and_in_the_table(comparison, ring, tmp_path):
    made = comparison({("lammps", 0): ring.trajectory(seed=1), ("liggghts", 0): ring.trajectory(seed=2)})
    written = write_report(made, tmp_path / "out")
    with open(tmp_path / "out" / "between_codes.csv", newline="") as f:
        rows = {row["quantity"]: row for row in csv.DictReader(f)}
    assert {"torque on the inner ring", "torque on the outer ring", "pressure", "volume fraction in the band",
            "s/d (width of the band)", "mean over cells of v_phi"} <= set(rows)
    assert rows["pressure"]["design"] == "time averages"
    assert "Numbers of codes beside each other</h2>" in written.page.read_text()


def test_area_fractions_stand_there_both_ways(comparison, ring):
    rows = number_rows(comparison({("lammps", 0): ring.trajectory()}))
    r = ring.scene.rings
    bare = 240 * 4e-6 / (r.outer_radius**2 - r.inner_radius**2)
    found = {row["quantity"]: row["value"] for row in rows if "area fraction" in row["quantity"]}
    assert found["area fraction of the bare annulus"] == pytest.approx(bare)
    assert found["area fraction of the free annulus"] > bare


def test_numbers_of_several_packings_are_means_with_their_error(comparison, ring):
    runs = {("lammps", k): ring.trajectory(seed=k, torque=1e-3 * (1 + k)) for k in range(3)}
    row = next(r for r in number_page_rows(comparison(runs)) if r["quantity"] == "torque on the inner ring")
    assert row["lammps"] == "-0.002 +- 0.00058 (n = 3)"


def test_a_run_that_crashed_leaves_the_others(comparison, ring):
    made = comparison({("lammps", 0): ring.trajectory(), ("liggghts", 0): None})
    assert {row["engine"] for row in profile_rows(made)} == {"lammps"}
    assert next(c for c in made.checks if c.quantity == "profiles").verdict == "not_checked"
    assert made.exit_status == 1


def test_nothing_that_completed_is_a_page_without_figures(comparison, ring, tmp_path):
    made = comparison({("lammps", 0): None, ("liggghts", 0): None})
    written = write_report(made, tmp_path / "out")
    assert written.picture is None
    assert couette.sections(made) == []


def test_without_contacts_what_needs_them_is_left_out_with_the_reason(comparison, ring):
    bare = ring.changed(("contacts = true", "contacts = false"))
    made = comparison({("lammps", 0): bare.trajectory(contacts=False)}, bare)
    headings = {s.heading: s for s in couette.sections(made)}
    assert not {"Stress", "Force chains"} & set(headings)
    assert "stress_rr, as contacts were not recorded" in headings["Profiles"].note


def test_profiles_of_other_engines_have_the_same_columns(comparison, ring):
    runs = {("lammps", 0): ring.trajectory(), ("liggghts", 0): ring.trajectory(contacts=False)}
    rows = profile_rows(comparison(runs))
    assert len({tuple(row) for row in rows}) == 1
    assert rows[0]["stress_rr (N/m)"] is not None
    assert rows[-1]["stress_rr (N/m)"] is None


def test_equal_codes_agree_in_profiles_and_windows(comparison, ring):
    t = ring.trajectory()
    made = comparison({("lammps", 0): t, ("liggghts", 0): t})
    verdicts = {c.quantity: c.verdict for c in made.checks if c.left == "lammps"}
    assert verdicts["torque on the inner ring up to 1 s"] == "agrees"
    assert verdicts["torque on the inner ring, whole test"] == "agrees"
    assert verdicts["profile: velocity"] == "agrees"
    assert not [c for c in made.checks if c.verdict == "differs" and c.level != "run"]


def test_another_velocity_is_found_and_named(comparison, ring):
    faster = ring.trajectory(seed=2, v_phi=lambda r: 0.011 * np.exp(-(r - 0.02) / 6e-3))
    made = comparison({("lammps", 0): ring.trajectory(seed=1), ("liggghts", 0): faster})
    check = next(c for c in made.checks if c.quantity == "profile: velocity")
    assert check.verdict == "differs"
    assert "v_phi" in check.why


def test_a_folder_where_a_table_goes_is_refused_before_anything_is_run(tmp_path):
    from harness.errors import InputError

    (tmp_path / "profiles.csv").mkdir()
    with pytest.raises(InputError, match="profiles.csv"):
        check_report_places(tmp_path)


def test_bands_of_the_torque_are_written_over_packings_only(comparison, ring, tmp_path):
    """Of 1, 2 and 3 times the same torque: mean 2, error 1/sqrt(3) of it."""
    out = tmp_path / "out"
    runs = {("lammps", k): ring.trajectory(seed=k, torque=1e-3 * (1 + k)) for k in range(3)}
    page = write_report(comparison(runs), out).page.read_text()
    with open(out / "wall_bands.csv", newline="") as f:
        rows = list(csv.DictReader(f))
    assert list(rows[0]) == ["engine", "time (s)", "replicates", *(
        f"{ring}_torque, {of} (N m)" for ring in ("inner", "outer") for of in ("mean", "standard error"))]
    assert {(r["engine"], r["replicates"]) for r in rows} == {("lammps", "3")}
    torque = np.array([[float(r[f"inner_torque, {of} (N m)"]) for r in rows] for of in ("mean", "standard error")])
    assert torque[0].mean() == pytest.approx(-2e-3, rel=0.02)
    assert torque[1].mean() == pytest.approx(1e-3 / np.sqrt(3), rel=0.05)
    assert "wall_bands.csv" in page
    assert "n = 3" in page
    alone = write_report(comparison({("lammps", 0): ring.trajectory()}), out)
    assert not (out / "wall_bands.csv").exists()
    assert "wall_bands" not in alone.page.read_text()
