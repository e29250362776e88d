"""A fitted law as a scene that any command takes: two spheres that meet head-on, with the law of the measurement."""

from __future__ import annotations

import math
from pathlib import Path

from harness.scene.load import load_scene
from harness.studies.reproduce.contact.back import Spheres
from harness.studies.reproduce.contact.fit import LawFit

TEMPLATE = """# Two spheres meet head-on under the law that was fitted to {source}.
#
# k_1 = {k_1:.4g} +- {e_1:.2g} N/m, k_2 = {k_2:.4g} +- {e_2:.2g} N/m, k_c = {k_c:.4g} +- {e_c:.2g} N/m (standard
# errors, covariance of the fit). The speed compresses to the largest overlap of the measurement, {nm:.3g} nm.
# Radius and density are not part of a measured curve: chosen. Written by `grainproof reproduce contact`.

kind = "free"
title = "Head-on collision with a fitted hysteretic law"
dimension = 3
duration = {duration!r}

[contact.normal]
law = "hysteretic"
loading_stiffness = {k_1!r}
unloading_stiffness = {k_2!r}
adhesion_stiffness = {k_c!r}
normal_damping = 0.0

[numerics]
dt_fraction = 0.005

[outputs]
samples = 400
frames = 80
contacts = true

[[bodies]]
position = [0.0, 0.0, 0.0]
radius = {radius!r}
mass = {mass!r}
velocity = [{speed!r}, 0.0, 0.0]

[[bodies]]
position = [{place!r}, 0.0, 0.0]
radius = {radius!r}
mass = {mass!r}
velocity = [{back!r}, 0.0, 0.0]

[[compare.agreements]]
pairs = "same_conventions"
tolerance = 1e-10
"""

FLIGHT = 0.2
"""Of free flight before the contact, over the time of loading."""


def write_fitted_scene(path: Path, fit: LawFit, spheres: Spheres, source: str) -> Path:
    """Write the scene, whole or not at all, and load it as a check that it is one; return its file.

    The spheres approach with v = D sqrt(k_1/m*), m* = m/2, which takes them to the largest overlap D.
    """
    from harness.runs.atomic import write_text_atomic

    k_1, k_2, k_c, _ = fit.values.tolist()
    e_1, e_2, e_c, _ = fit.errors.tolist()
    rate = math.sqrt(k_1 / (spheres.mass / 2))
    speed, loading = fit.largest * rate, math.pi / 2 / rate
    text = TEMPLATE.format(
        source=source, k_1=k_1, k_2=k_2, k_c=k_c, e_1=e_1, e_2=e_2, e_c=e_c, nm=1e9 * fit.largest,
        radius=spheres.radius, mass=spheres.mass, speed=speed / 2, back=-speed / 2, duration=4 * loading,
        place=2 * spheres.radius + FLIGHT * speed * loading,
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text_atomic(path, text)
    load_scene(path)
    return path
