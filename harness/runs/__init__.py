"""Runs: folders named by content, outcomes as values, one run, many runs."""
