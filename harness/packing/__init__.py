"""Initial states: random loose insertion, frictionless compression to a pressure, cached by content."""

from harness.packing.make import Packing, make_packing

__all__ = ["Packing", "make_packing"]
