"""Contact laws, proven in every code that has them: prescribed motion (L0) and collisions (L1)."""

from harness.studies.laws.study import LawsResult, choose_laws, prove_laws

__all__ = ["LawsResult", "choose_laws", "prove_laws"]
