"""What accuracy costs in time: ladders of a knob, errors against an oracle, CPU time a step."""

from harness.studies.accuracy.study import Accuracy, accuracy

__all__ = ["Accuracy", "accuracy"]
