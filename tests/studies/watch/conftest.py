"""Small scenes with exact answers, written to files."""

from pathlib import Path

import pytest

LINEAR = 'normal = {law = "linear", normal_stiffness = 1e5, normal_damping = %g, attraction = "allowed"}'


@pytest.fixture
def head_on(tmp_path):
    """Two equal discs that meet head-on at 1 m/s relative speed: m* = 5e-7 kg, k = 1e5 N/m."""

    def write(damping: float = 0.0, more: str = "", normal: str = "") -> Path:
        file = tmp_path / "head_on.toml"
        file.write_text(f"""
kind = "free"
title = "head-on"
dimension = 2
duration = 4e-5
bodies = [
    {{position = [0.0, 0.0], radius = 1e-3, mass = 1e-6, velocity = [0.5, 0.0]}},
    {{position = [0.0020001, 0.0], radius = 1e-3, mass = 1e-6, velocity = [-0.5, 0.0]}},
]
{more}
[contact]
{normal or LINEAR % damping}
[numerics]
dt_fraction = 0.005
[outputs]
samples = 200
frames = 100
contacts = true
""")
        return file

    return write


@pytest.fixture
def pushed(tmp_path):
    """A disc that a wall pushes with 0.1 m/s from touching on: it leaves with twice the wall's speed."""

    def write() -> Path:
        file = tmp_path / "pushed.toml"
        file.write_text(f"""
kind = "free"
title = "pushed"
dimension = 2
duration = 3e-5
bodies = [{{position = [0.001, 0.0], radius = 1e-3, mass = 1e-6}}]
[[planes]]
name = "piston"
point = [-1e-9, 0.0]
normal = [1.0, 0.0]
friction = false
motion = {{kind = "constant", velocity = [0.1, 0.0]}}
[contact]
{LINEAR % 0.0}
[numerics]
dt_fraction = 0.005
[outputs]
samples = 200
frames = 20
contacts = true
""")
        return file

    return write
