"""The largest stable time step of every code, law and packing, measured, and what theory says."""

from harness.studies.frontier.study import Frontiers, frontiers

__all__ = ["Frontiers", "frontiers"]
