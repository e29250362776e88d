"""The harness: scenes in, engines driven, runs kept, results judged and shown."""

__version__ = "0.1.0"

SCHEMA = 1
"""Version of scene meaning and run-folder layout; part of every run's hash."""
