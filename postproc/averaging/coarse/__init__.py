"""Coarse graining: averages at points, with a kernel in place of cells.

Source: Goldhirsch, Granular Matter 12, 239 (2010); walls: Weinhart, Thornton, Luding, Bokhove, Granular Matter 14,
289 (2012). A new kernel is a module in `kernels` and a line in its registry.
"""
