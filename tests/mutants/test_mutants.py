"""Wrong physics, run through the laws study as if it were a code: each must be caught, and by the check that is named.

A mutant is the kernel with one thing wrong. It is judged twice: as a code beside the true kernel in its conventions,
and alone, against closed forms and against itself in other frames, as the kernel itself would be if it were wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from functools import partial
from unittest import mock

import numpy as np
import pytest

from harness.studies.laws.arrangement import arrangement
from harness.studies.laws.cases import CASES
from harness.studies.laws.drive import Driver, Job
from harness.studies.laws.frame_checks import frame_deviations
from harness.studies.laws.judge import CLOSED_FORM, PLAIN_FRAME, judge_engine
from harness.studies.laws.stepped import Stepper
from reference.kernel import interactions, neighbours
from reference.kernel.laws import (
    hertz,
    hysteretic,
    hysteretic_variable,
    law,
    rolling,
    slider,
    sliding,
    torsion,
)

FORM, FRAME = CLOSED_FORM, PLAIN_FRAME


@dataclass(frozen=True)
class Mutant:
    """What is wrong; in which laws and convention it is looked for; `caught`: (motion, what it is compared with)."""

    name: str
    laws: str
    caught: tuple[tuple[str, str], ...]
    patches: tuple[tuple[object, str, object], ...]
    convention: str = "talk"
    partner: str = "pair"
    dimension: int = 3
    frame: str = ""

    @contextmanager
    def __call__(self) -> Iterator[None]:
        with ExitStack() as stack:
            for target, attribute, wrong in self.patches:
                stack.enter_context(mock.patch.object(target, attribute, wrong))
            yield


# --- what is wrong ---------------------------------------------------------------------------------


def no_friction(self, contact, pressing, memory, dt, *, advance):
    return np.zeros_like(contact.v_t), memory


def no_couple(true: Callable, self, contact, pressing, memory, dt, *, advance):
    couple, memory = true(self, contact, pressing, memory, dt, advance=advance)
    return np.zeros_like(couple), memory


def other_couple(true: Callable, factor: float, self, contact, pressing, memory, dt, *, advance):
    couple, memory = true(self, contact, pressing, memory, dt, advance=advance)
    return factor * couple, memory


def unturned(true: Callable, self, memory, rate, base, n, dt, **named):
    return true(self, memory, rate, base, None, dt, **named)


def untruncated(true: Callable, self, memory, rate, base, n, dt, **named):
    """The force is cut to the limit, the spring goes on stretching."""
    force, _ = true(self, memory, rate, base, n, dt, **named)
    _, memory = true(self, memory, rate, 1e9 * base, n, dt, **named)
    return force, memory


def on_elastic_force(true: Callable, self, contact, f_n, elastic):
    return true(self, contact, elastic, elastic)


def boundless(true: Callable, *arguments):
    pressing = true(*arguments)
    return replace(pressing, base=1e9 * pressing.base)


def radius_arms(radius_i, radius_j, overlap, arm):
    return radius_i, radius_j


def reduced_arms(radius_i, radius_j, overlap, arm):
    return radius_i - 0.5 * overlap, radius_j - 0.5 * overlap


def own_mass(true: Callable, self, quantity, i, j):
    return quantity.take(i) if quantity is self.model.mass else true(self, quantity, i, j)


def own_radius(true: Callable, self, quantity, i, j):
    return quantity.take(i) if quantity is self.model.radius else true(self, quantity, i, j)


def swapped_stiffnesses(true: Callable, self, contact, memory):
    other = replace(self, loading_stiffness=self.unloading_stiffness, unloading_stiffness=self.loading_stiffness)
    return true(other, contact, memory)


def no_adhesion_limit(force, overlap, largest, k_1, k_2, k_c):
    return force, largest[None]


def not_drawn_back(force, overlap, largest, k_1, k_2, k_c):
    return np.maximum(force, -k_c * overlap), largest[None]


def no_shift(self, contact, total, elastic):
    return total


def opened_contacts_remember(self, touching, memory):
    for family, kept in self.memory.items():
        kept[:, touching] = memory[family]


def anti_damping(true: Callable, self, contact):
    gamma = true(self, contact)
    return None if gamma is None else -gamma


def negative(true: Callable, *arguments):
    return -true(*arguments)


def never_slides_dynamically(true: Callable, self, *arguments, **named):
    return true(replace(self, dynamic_friction=self.friction), *arguments, **named)


def of(true, wrong, *bound):
    """A wrong function that knows the true one, fit to be a method."""
    made = partial(wrong, true, *bound)

    def method(*arguments, **named):
        return made(*arguments, **named)

    return method


SLIDER, INTERACTION, NORMAL = slider.Slider, interactions.Interaction, law.NormalLaw

MUTANTS = (
    Mutant("friction dropped", "linear+spring", (("shear", FORM), ("load_shear", FORM)),
           ((sliding.SpringSliding, "force", no_friction),)),
    Mutant("spring not rotated", "linear+spring", (("load_shear", FRAME),),
           ((SLIDER, "move", of(SLIDER.move, unturned)),), frame="turning"),
    Mutant("spring not rescaled", "linear+spring", (("load_shear", FRAME),),
           ((slider, "_rescaled", lambda turned, old: turned),), frame="turning"),
    Mutant("torque sign", "linear+spring", (("shear", FORM),),
           ((interactions, "torque_cross", of(interactions.torque_cross, negative)),)),
    Mutant("lever arm of slip and torque R", "linear+spring", (("shear", FORM), ("load_shear", FRAME)),
           ((interactions, "_arms", radius_arms),), frame="turning"),
    Mutant("lever arm of slip and torque R - overlap/2", "linear+spring", (("shear", FORM), ("load_shear", FORM)),
           ((interactions, "_arms", reduced_arms),), convention="lammps"),
    Mutant("damping on the wrong mass", "hertz", (("load", FORM),),
           ((INTERACTION, "_reduced", of(INTERACTION._reduced, own_mass)),)),
    Mutant("tangential damping on the wrong mass", "hertz+mindlin", (("shear", FORM),),
           ((INTERACTION, "_reduced", of(INTERACTION._reduced, own_mass)),), convention="lammps"),
    Mutant("stiffness of the wrong radius", "hertz", (("load", FORM),),
           ((INTERACTION, "_reduced", of(INTERACTION._reduced, own_radius)),)),
    *(
        Mutant(f"spring not truncated on sliding, {name}", "linear+spring", (("shear", FORM),),
               ((SLIDER, "move", of(SLIDER.move, untruncated)),), convention=name)
        for name in ("lammps", "liggghts")
    ),
    Mutant("k_1 and k_2 swapped", "hysteretic", (("load", FORM), ("shear", FORM)),
           ((hysteretic.HystereticNormal, "elastic", of(hysteretic.HystereticNormal.elastic, swapped_stiffnesses)),)),
    Mutant("adhesion limit missing", "hysteretic", (("load", FORM),),
           ((hysteretic, "with_adhesion", no_adhesion_limit),)),
    Mutant("adhesion without drawing back", "hysteretic", (("load", FORM),),
           ((hysteretic, "with_adhesion", not_drawn_back),)),
    Mutant("friction not shifted by the adhesion", "hysteretic+spring", (("shear", FORM),),
           ((NORMAL, "gripping", no_shift),)),
    Mutant("k_2 does not grow", "hysteretic_variable", (("load", FORM),),
           ((hysteretic_variable.VariableHystereticNormal, "elastic",
             lambda self, contact, memory: hysteretic.HystereticNormal(
                 loading_stiffness=self.loading_stiffness, unloading_stiffness=self.largest_unloading_stiffness,
                 adhesion_stiffness=self.adhesion_stiffness, normal_damping=0.0,
             ).elastic(contact, memory)),)),
    Mutant("rolling couple dropped", "linear+spring+rolling", (("roll", FORM),),
           ((rolling.SpringRolling, "couple", of(rolling.SpringRolling.couple, no_couple)),)),
    Mutant("rolling couple with the rolling", "linear+spring+rolling", (("roll", FORM),),
           ((rolling.SpringRolling, "couple", of(rolling.SpringRolling.couple, other_couple, -1.0)),)),
    Mutant("rolling couple without its lever", "linear+rolling", (("roll", FORM),),
           ((rolling.SpringRolling, "couple", of(rolling.SpringRolling.couple, other_couple, 2.0)),), partner="plane"),
    Mutant("torsion couple dropped", "linear+spring+torsion", (("twist", FORM),),
           ((torsion.SpringTorsion, "couple", of(torsion.SpringTorsion.couple, no_couple)),)),
    Mutant("opened contacts remember", "linear+spring", (("shear", FORM),),
           ((neighbours.CandidateList, "remember", opened_contacts_remember),), convention="liggghts"),
    Mutant("opened contacts remember their plasticity", "hysteretic", (("load", FORM),),
           ((neighbours.CandidateList, "remember", opened_contacts_remember),), partner="plane", dimension=2),
    Mutant("friction of the elastic force alone", "linear+spring", (("load_shear", FORM),),
           ((INTERACTION, "pressing", of(INTERACTION.pressing, on_elastic_force)),)),
    Mutant("damping with the wrong sign", "hertz", (("load", FORM),),
           ((hertz.HertzNormal, "damping", of(hertz.HertzNormal.damping, anti_damping)),)),
    Mutant("attraction not clipped", "hertz_clipped", (("load", FORM),),
           ((NORMAL, "force", lambda self, contact, memory: (
               self.elastic(contact, memory)[0] - self.damping(contact) * contact.v_n,
               self.elastic(contact, memory)[0], memory)),)),
    Mutant("Mindlin's stiffness of Hertz", "hertz+mindlin", (("shear", FORM), ("load_shear", FORM)),
           ((hertz.HertzNormal, "shear_stiffness", hertz.HertzNormal.normal_stiffness),), convention="lammps"),
    Mutant("no dynamic coefficient", "linear+spring_dynamic", (("shear", FORM),),
           ((SLIDER, "move", of(SLIDER.move, never_slides_dynamically)),), convention="lammps"),
    Mutant("viscous friction without limit", "linear+viscous", (("load_shear", FORM),),
           ((INTERACTION, "pressing", of(INTERACTION.pressing, boundless)),)),
)


# --- the tests -------------------------------------------------------------------------------------


def judge(mutant: Mutant, engine, kernel, folder) -> tuple[list, object]:
    """Return all checks of a mutant beside the true kernel, and the mutant's run."""
    laws = CASES[mutant.laws]
    place = arrangement(mutant.partner, mutant.dimension, laws.grains)
    driver = Driver(root=folder, time_limit=60.0, workers=1)
    ((run, true),) = driver.each([[Job(laws=laws, engine=e, arrangement=place) for e in (engine, kernel)]])
    assert run.status == true.status == "completed", run.reason
    return judge_engine(laws, engine.name, {run.part: run}, {true.part: true}, "again"), run


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: m.name)
def test_mutant_is_caught_by_the_named_checks(mutant, kernel_inside, tmp_path):
    kernel = kernel_inside(mutant.convention)
    code = kernel_inside(mutant.convention, name=mutant.convention, changed=mutant)
    checks, run = judge(mutant, code, kernel, tmp_path)
    differing = {(c.quantity, c.right) for c in checks if c.verdict == "differs"}
    for motion, right in mutant.caught:
        named = f"{mutant.laws}: {motion}"
        assert (named, right) in differing
        if right == FORM:
            assert (named, kernel.name) in differing
    if mutant.frame:
        motion = next(m for m, right in mutant.caught if right == FRAME)
        found = frame_deviations(run, motion, mutant.convention, Stepper(laws=CASES[mutant.laws]))
        assert mutant.frame in {d.frame for d in found if d.size > 1e-6}
    again = [c.why for c in checks if c.verdict == "differs"]
    assert all(why.endswith("rerun: again") for why in again)


@pytest.mark.parametrize("convention", ["lammps", "liggghts", "talk"])
def test_an_engine_that_changes_nothing_is_no_mutant(convention, kernel_inside, tmp_path):
    harmless = Mutant("nothing", "linear+spring", (), ())
    code = kernel_inside(convention, name=convention, changed=harmless)
    checks, _ = judge(harmless, code, kernel_inside(convention), tmp_path)
    assert {c.verdict for c in checks} <= {"agrees", "known_difference"}
    assert {c.deviation for c in checks if c.right == f"kernel:{convention}"} == {0.0}
