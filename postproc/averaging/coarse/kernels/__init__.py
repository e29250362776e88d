"""Kernels of coarse graining, one a module."""
