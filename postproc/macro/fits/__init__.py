"""Curves through measured profiles and histories: parameters with errors, or the reason why there are none."""
