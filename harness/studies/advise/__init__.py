"""Advice on time step, stiffness, rate, number of particles and effects, from measured ladders."""

from harness.studies.advise.read import read_evidence
from harness.studies.advise.study import Advice, advise
from harness.studies.advise.verification import Verification

__all__ = ["Advice", "Verification", "advise", "read_evidence"]
