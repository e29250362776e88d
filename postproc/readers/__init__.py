"""Readers: output of any code in, snapshots and trajectories out."""
