"""Names of files and the marker: what the deck, the child process and the reader have to agree on."""

DECK, PACKING, CONTACTS = "in.lammps", "packing.data", "contacts.in"
LOG = "log.lammps"
STATE = "state"
"""Restart files are called state.<step>."""
MARKER = "grainproof finished:"
"""First words of the line by which the child process says that it got to the end."""
