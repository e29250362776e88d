"""Scenes as plain data, written to TOML; edits by path, so that a test shows only what it changes."""

import copy
import datetime
import json
import math
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.scene.load import load_scene

LINEAR = {"law": "linear", "normal_stiffness": 1e5, "normal_damping": 0.1, "attraction": "allowed"}
SPRING = {"law": "spring", "shear_friction": 0.5, "shear_stiffness": 2e4, "shear_damping": 0.025}
NORMALS = {
    "linear": LINEAR,
    "hertz": {
        "law": "hertz", "youngs_modulus": 1e8, "poisson_ratio": 0.3, "restitution": 0.9, "attraction": "allowed",
        "impact_speed": 0.1,
    },
    "hysteretic": {
        "law": "hysteretic", "loading_stiffness": 5e4, "unloading_stiffness": 1e5, "adhesion_stiffness": 2e4,
        "normal_damping": 0.05,
    },
    "hysteretic_variable": {
        "law": "hysteretic_variable", "loading_stiffness": 5e4, "largest_unloading_stiffness": 1e5,
        "adhesion_stiffness": 2e4, "plasticity_depth": 0.05, "normal_damping": 0.05,
    },
    "dmt": {
        "law": "dmt", "youngs_modulus": 1e8, "poisson_ratio": 0.3, "surface_energy": 0.05, "normal_damping": 0.01,
        "impact_speed": 0.1,
    },
    "jkr": {
        "law": "jkr", "youngs_modulus": 1e8, "poisson_ratio": 0.3, "surface_energy": 0.05, "normal_damping": 0.01,
        "impact_speed": 0.1,
    },
}
SLIDINGS = {
    "spring": SPRING,
    "mindlin": {"law": "mindlin", "shear_friction": 0.5},
    "viscous": {"law": "viscous", "shear_friction": 0.5, "shear_damping": 0.1},
}
ROLLINGS = {
    "spring": {"law": "spring", "rolling_friction": 0.1, "rolling_stiffness": 1e4, "rolling_damping": 0.01},
    "constant": {"law": "constant", "rolling_friction": 0.1},
}
TORSION = {"law": "spring", "torsion_friction": 0.1, "torsion_stiffness": 1e4, "torsion_damping": 0.01}
OUTPUTS = {"samples": 20, "frames": 10, "contacts": True}

BIAXIAL = {
    "kind": "biaxial",
    "title": "box",
    "particles": {
        "count": 100, "seed": 3, "inertia": "disc", "radius": {"kind": "uniform", "min": 0.5e-3, "max": 1.5e-3},
        "mass": {"kind": "sphere", "density": 2000.0},
    },
    "preparation": {"pressure": 100.0, "residual_tolerance": 1e-8},
    "contact": {"normal": LINEAR, "sliding": SPRING},
    "top": {"final_strain": 0.1, "duration": 0.01},
    "side": {"pressure": 100.0, "mass": 2e-4, "damping": 0.1},
    "numerics": {"dt_fraction": 0.05},
    "outputs": OUTPUTS,
}

RING = {
    "kind": "couette",
    "title": "ring",
    "duration": 0.1,
    "particles": {
        "seed": 3, "inertia": "disc", "mass": {"kind": "disc", "density": 1060.0, "height": 6e-3},
        "species": [{"count": 140, "radius": 3.71e-3}, {"count": 23, "radius": 4.495e-3}],
    },
    "rings": {"inner_radius": 0.02, "outer_radius": 0.06, "grain_radius": 1.25e-3, "omega": 1.0},
    "preparation": {"start_size": 0.5, "grow": 0.2, "settle": 0.05},
    "contact": {
        "normal": {"law": "linear", "normal_stiffness": 352.1, "normal_damping": 0.19, "attraction": "allowed"},
        "sliding": {"law": "viscous", "shear_friction": 0.44, "shear_damping": 0.15},
    },
    "numerics": {"dt_fraction": 0.04},
    "outputs": OUTPUTS,
    "compare": {"steady_from": 0.05, "band": 0.02},
}

FREE = {
    "kind": "free",
    "title": "two discs",
    "dimension": 2,
    "duration": 1e-4,
    "contact": {"normal": LINEAR, "sliding": SPRING},
    "numerics": {"dt_fraction": 0.05},
    "outputs": OUTPUTS,
    "bodies": [
        {"position": [0.0, 2e-3], "radius": 1e-3, "mass": 1e-5, "velocity": [0.1, 0.0], "spin": [3.0]},
        {"position": [2.1e-3, 2e-3], "radius": 1e-3, "mass": 1e-5, "inertia": "disc"},
    ],
}

FLOOR = {"name": "floor", "point": [0.0, 0.0], "normal": [0.0, 2.0], "friction": True}
LID = {"name": "lid", "point": [0.0, 5e-3], "normal": [0.0, -1.0], "friction": False}

BALLS = {
    "dimension": 3,
    "bodies": [
        {"position": [0.0, 2e-3, 0.0], "radius": 1e-3, "mass": 1e-5, "velocity": [0.1, 0, 0], "spin": [1.0, 2.0, 3.0]},
        {"position": [2.1e-3, 2e-3, 0.0], "radius": 1e-3, "mass": 1e-5},
    ],
}
"""Changes that turn `FREE` into two spheres in space."""

REMOVE = object()


def dump(value, top=True) -> str:
    """Write data as TOML; tables below the top inline."""
    if isinstance(value, dict):
        items = [f"{json.dumps(k)} = {dump(v, False)}" for k, v in value.items()]
        return "\n".join(items) if top else "{" + ", ".join(items) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(dump(v, False) for v in value) + "]"
    if isinstance(value, datetime.date):
        return value.isoformat()
    if isinstance(value, str):
        return json.dumps(value).replace("\x7f", "\\u007f")
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return json.dumps(value)


def edited(data: dict, changes: dict) -> dict:
    """Return a copy with values replaced, added or removed by path, e.g. {"top.duration": 1.0}."""
    data = copy.deepcopy(data)
    for path, value in changes.items():
        *parents, last = [int(k) if k.isdigit() else k for k in path.split(".")]
        table = data
        for key in parents:
            table = table.setdefault(key, {}) if isinstance(table, dict) else table[key]
        if value is REMOVE:
            del table[last]
        else:
            table[last] = copy.deepcopy(value)
    return data


class Scenes:
    """Writes scenes into a folder and loads them."""

    biaxial, ring, free, floor, lid, remove, balls = BIAXIAL, RING, FREE, FLOOR, LID, REMOVE, BALLS
    normals, slidings, rollings, torsion = NORMALS, SLIDINGS, ROLLINGS, TORSION
    dump, edited = staticmethod(dump), staticmethod(edited)

    def __init__(self, folder: Path):
        self.folder = folder
        self.file = folder / "scene.toml"

    def write(self, text: str | bytes, name: str = "scene.toml") -> Path:
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    def load(self, base: dict, changes: dict | None = None):
        return load_scene(self.write(dump(edited(base, changes or {}))))

    def refusal(self, base: dict, changes: dict | None = None) -> str:
        """Return the message with which a scene is refused, without the folder; it must be one line."""
        with pytest.raises(InputError) as caught:
            self.load(base, changes)
        return self.message(caught)

    def refused_text(self, text: str | bytes) -> str:
        with pytest.raises(InputError) as caught:
            load_scene(self.write(text))
        return self.message(caught)

    def message(self, caught) -> str:
        line = str(caught.value)
        assert line.isprintable()
        assert len(line) < 600
        assert "Traceback" not in line
        return line.replace(str(self.folder) + "/", "")


@pytest.fixture
def scenes(tmp_path):
    return Scenes(tmp_path)


@pytest.fixture(scope="session")
def shared_scenes(tmp_path_factory):
    return Scenes(tmp_path_factory.mktemp("scenes"))
