"""Two dimensions, in complex numbers."""
