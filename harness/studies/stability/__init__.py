"""Hard cases: is each code stable there, and if not, does it say so?"""

from harness.studies.stability.study import Stability, stability

__all__ = ["Stability", "stability"]
