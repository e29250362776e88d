"""What contacts remember, for laws in company: carried, forgotten, not touched by looking; what of it is written."""

import json

import numpy as np
import pytest

from reference.kernel.deck import read_deck
from reference.kernel.laws.registry import build_law
from reference.kernel.output import contact_table

CONVENTIONS = ("lammps", "liggghts", "talk")
PLASTIC = {"normal": "hysteretic", "sliding": "spring", "rolling": "spring", "torsion": "spring"}
ELASTIC = {"normal": "hertz", "sliding": "mindlin", "rolling": "spring", "torsion": "spring"}
GROWING = {"normal": "hysteretic_variable", "sliding": "viscous", "rolling": "constant"}
BARE = {"normal": "dmt"}


def tables(dem, words, dim=3, **changes):
    return {family: dem.table(family, word, **changes.get(family, {})) for family, word in words.items()
            if (family, dim) != ("torsion", 2)}


def crowd(dem, words, dim=3, convention="talk", **changes):
    walls = dem.box(5.2 if dim == 2 else 3.4, dim, friction=("x0", "y0"))
    return dem.cluster(7, dim, across=3 if dim == 2 else 2, squeeze=0.8, speed=3.0, walls=walls, convention=convention,
                       **tables(dem, words, dim, **changes))


@pytest.mark.parametrize("words", [PLASTIC, ELASTIC, GROWING], ids=lambda w: w["normal"])
@pytest.mark.parametrize("convention", CONVENTIONS)
def test_neither_the_skin_nor_looking_shows_to_the_last_bit(dem, words, convention):
    m = crowd(dem, words, convention=convention, **({"sliding": {"dynamic_friction": 0.2}} if words is PLASTIC else {}))
    plain, watched = dem.Simulation(m), dem.Simulation(m, skin=0.02)
    for _ in range(80):
        plain.advance()
        watched.advance()
        watched.contacts()
    assert watched.rebuilds > plain.rebuilds
    assert dem.bytes(plain) == dem.bytes(watched)


@pytest.mark.parametrize(("words", "rows"), [
    (PLASTIC, {"normal": 1, "sliding": 3, "rolling": 3, "torsion": 1}),
    (ELASTIC, {"sliding": 3, "rolling": 3, "torsion": 1}), (GROWING, {"normal": 1}), (BARE, {})],
    ids=["plastic", "elastic", "growing", "bare"])
def test_memory_is_there_for_laws_with_history_and_for_no_others(dem, words, rows):
    simulation = dem.Simulation(crowd(dem, words))
    for interaction in simulation.interactions:
        smooth = interaction.walls is not None and interaction.sliding is None
        expected = {"normal": rows["normal"]} if smooth and "normal" in rows else {} if smooth else rows
        assert {family: len(kept) for family, kept in interaction.pairs.memory.items()} == expected
    assert (simulation.state.torque is None) == (words is BARE)


def test_laws_that_ask_for_nothing_are_given_nothing(dem):
    simulation = dem.run(dem.Simulation(crowd(dem, {"normal": "linear"})), 5)
    for interaction in simulation.interactions:
        contact = interaction.last.contact
        unused = ("v_t", "torque_arm_i", "torque_arm_j", "spin", "reduced_radius", "reduced_mass")
        assert all(getattr(contact, name) is None for name in unused)


def test_the_state_of_dynamic_friction_is_one_row_more(dem):
    words = {"normal": "linear", "sliding": "spring"}
    for convention, rows in (("talk", 3), ("lammps", 3), ("liggghts", 2)):
        m = crowd(dem, words, 2, convention, sliding={"dynamic_friction": 0.1})
        assert len(dem.Simulation(m).interactions[0].pairs.memory["sliding"]) == rows


def test_an_overlap_at_the_start_is_remembered(dem):
    """Two discs that begin 0.1 deep are loaded so far: as they part they unload along k_2."""
    m = dem.model([[0.0, 0.0], [1.9, 0.0]], v=[[0.0, 0.0], [1.0, 0.0]], normal=dem.table(
        "normal", "hysteretic", normal_damping=0.0))
    simulation = dem.Simulation(m)
    assert simulation.interactions[0].pairs.memory["normal"].tolist() == [[pytest.approx(0.1)]]
    simulation.advance()
    overlap = simulation.interactions[0].last.contact.overlap[0]
    assert overlap < 0.1
    assert simulation.interactions[0].last.f_n[0] == pytest.approx(4e3 * 0.1 - 1e4 * (0.1 - overlap), rel=1e-12)


def test_forgotten_on_opening_and_kept_through_a_rebuild(dem):
    """Pressed to 0.1, back to 0.09: 300 N on the k_2 line, over rebuilds; apart and again: 360 N of first loading."""
    m = dem.model([[0.0, 0.0], [2.1, 0.0]], normal=dem.table("normal", "hysteretic", normal_damping=0.0))
    simulation = dem.Simulation(m)

    def place(overlap):
        simulation.state.x[0, 1] = 2.0 - overlap
        simulation._rebuild()
        simulation.evaluate(advance=True)
        return simulation.state.force[0, 1]

    assert [place(d) for d in (0.1, 0.09, -0.01, 0.09)] == pytest.approx([400.0, 300.0, 0.0, 360.0])


# --- what is written ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("words", "written"), [(PLASTIC, True), (ELASTIC, True), (GROWING, False), (BARE, False)],
                         ids=["spring", "mindlin", "viscous", "frictionless"])
def test_contacts_have_an_elongation_where_sliding_has_a_spring(dem, words, written):
    simulation = dem.run(dem.Simulation(crowd(dem, words)), 40)
    table = contact_table(simulation)
    assert ({"ux", "uy", "uz"} <= set(table)) == written
    if written:
        pairs = simulation.interactions[0]
        rows = np.flatnonzero(table["j"] > 0)
        kept = pairs.pairs.memory["sliding"][:3, pairs.last.touching]
        np.testing.assert_array_equal(np.stack([table["ux"], table["uy"], table["uz"]])[:, rows], kept)


def test_the_deck_names_every_law(dem, tmp_path):
    """Each law is built from its table, with what the convention chooses; a law that the kernel has not is refused."""
    deck = {"title": "t", "dimension": 3, "convention": "liggghts", "dt": 1e-4, "walls": [],
            "plan": {"steps": 1, "sample_every": 1, "frame_every": 1, "contacts": False}}
    (tmp_path / "particles.csv").write_text("id,x,y,z,radius,mass,inertia,vx,vy,vz,wx,wy,wz\n1" + ",1" * 12 + "\n")
    for family, word in dem.tables:
        (tmp_path / "kernel.json").write_text(json.dumps(deck | dem.contact_with(family, word)))
        law = getattr(read_deck(tmp_path)[0], family)
        for name, value in dem.tables[family, word].items():
            assert getattr(law, name) == value
        for field, choice in law.choices.items():
            assert getattr(law, field) == {"sliding": "liggghts", "rolling": "liggghts", "torsion": "liggghts",
                                           "rolling_frame": "space", "viscous_limit": "total",
                                           "constant_rolling": "liggghts"}[choice]
    with pytest.raises(ValueError, match="normal: expected one of linear, hertz, .* got the law 'jkr'"):
        build_law("normal", {"law": "jkr"}, None)


def test_mindlin_without_hertz_is_refused(dem):
    with pytest.raises(ValueError, match="expected the normal law 'hertz', got LinearNormal"):
        dem.model([[0.0, 0.0]], sliding=dem.table("sliding", "mindlin"))


def test_torsion_in_two_dimensions_is_refused(dem):
    with pytest.raises(ValueError, match="torsion resistance: expected three dimensions"):
        dem.model([[0.0, 0.0]], torsion=dem.table("torsion", "spring"))
