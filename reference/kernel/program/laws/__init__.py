"""One file a law: its formula, and the operations that compute it in place.

What they find and what they leave in `Contacts` stands there; where nothing touches, velocities are 0 and so is what
they leave. `registry` says which operations a law of the textbook has.
"""
