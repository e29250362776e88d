"""What a finished run says of itself: energies, momentum, overlaps, displacements; the run is not altered by it."""

from harness.studies.watch.keep import watched
from harness.studies.watch.watch import Watch, watch, watch_folder

__all__ = ["Watch", "watch", "watch_folder", "watched"]
