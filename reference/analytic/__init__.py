"""Closed forms, one file a family, each with its source and range of validity."""
