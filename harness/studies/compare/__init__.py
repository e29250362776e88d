"""Compare the codes on one scene: same packings, every engine, verdicts and a report."""

from harness.studies.compare.study import Comparison, compare

__all__ = ["Comparison", "compare"]
