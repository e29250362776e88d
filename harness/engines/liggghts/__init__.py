"""LIGGGHTS-PUBLIC as an engine."""

from harness.engines.liggghts.engine import LIGGGHTS

__all__ = ["LIGGGHTS"]
