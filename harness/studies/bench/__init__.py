"""Speed: the kernel against the codes, on the same packing, in short interleaved rounds on one core."""

from harness.studies.bench.study import Bench, announced, bench

__all__ = ["Bench", "announced", "bench"]
