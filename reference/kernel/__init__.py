"""A textbook DEM kernel in NumPy: 2D discs and 3D spheres, one file a contact law.

Arrays are component-major: a vector quantity of M objects has shape (dim, M), a spin (1, M) in 2D
and (3, M) in 3D. The contact normal n points from j to i; overlap and compression are positive.
"""
