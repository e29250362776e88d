"""Averaging cells: weights, volumes and the three ways to average over them."""
