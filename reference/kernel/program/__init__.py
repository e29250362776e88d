"""The fast kernel: the step as a flat list of in-place operations, composed from the effects that are on.

The textbook evaluation (`reference.kernel.simulation`) defines what is computed; this package computes the same
numbers to round-off, several times faster. Read `simulation.py` first, then `compose.py`; `laws/registry.py` says which
operations each law has, `pairs.py` and `contacts.py` in which buffers they work.
"""
