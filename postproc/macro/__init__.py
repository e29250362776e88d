"""Macroscopic quantities, one idea a module; each formula with its source, units and sign."""
