"""The in-house NumPy kernel as an engine, once for each convention it can compute in."""

from harness.engines.kernel.engine import KERNELS

__all__ = ["KERNELS"]
