"""The independent post-processor: states of any code in, micro-macro quantities out.

Imports neither `harness` nor `reference`, so that an error there cannot hide here.
"""
