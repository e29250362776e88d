"""Speed: the kernel against the codes, on the same packing, in short interleaved rounds on one core."""

from harness.studies.bench.study import Bench, bench

__all__ = ["Bench", "bench"]
