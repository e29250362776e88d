"""What accuracy costs in time: ladders of knobs, errors against an oracle or a limit, CPU time."""

from harness.studies.accuracy.bulk import BulkAccuracy
from harness.studies.accuracy.study import Accuracy, accuracy

__all__ = ["Accuracy", "BulkAccuracy", "accuracy"]
