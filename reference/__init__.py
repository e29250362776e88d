"""The in-house reference: a NumPy DEM kernel, closed forms and tabulated values.

Imports neither `harness` nor `postproc`, and shares no line with the engines it judges.
"""
