"""Initial states: discs compressed to a pressure, or grown in shear between rings; cached by content."""

from harness.packing.grow import Flow, grow_ring
from harness.packing.make import Packing, make_packing

__all__ = ["Flow", "Packing", "grow_ring", "make_packing"]
