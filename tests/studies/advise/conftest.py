"""Ladders made up from formulas, so that the advice they lead to is known."""

import json
import math
from dataclasses import dataclass, field
from pathlib import Path

import msgspec
import pytest

from harness.scene.load import load_scene
from harness.studies.accuracy.asked import KNOBS
from harness.studies.advise.files import BULK_SCHEMA

FILE = Path(__file__).resolve().parents[3] / "inputs" / "scenes" / "biaxial_quick.toml"
SCALE = 25.0


@dataclass
class Study:
    """A finished study of biaxial_quick. knobs: by name {value: (error, bar, seconds)}, the coarsest first."""

    folder: Path
    knobs: dict
    spread: float = 0.0
    packings: int = 8
    engines: tuple = ("lammps",)
    dearer: dict = field(default_factory=dict)
    state: str = "extrapolated"
    order: float = 1.0
    effects: dict | None = None
    scene: object = None
    largest: float | None = None

    def __post_init__(self):
        self.scene = self.scene or load_scene(FILE)
        self.own = {k: KNOBS[type(self.scene)][k].own(self.scene) for k in self.knobs}

    def write(self):
        """Write both files; return the folder."""
        rows = [r for e in self.engines for k in self.knobs for r in self._rows(e, k)]
        plain = msgspec.to_builtins(self.scene)
        data = {
            "schema": BULK_SCHEMA, "scene": plain, "knobs": list(self.knobs), "quantity": "friction_angle",
            "quantities": {"friction_angle": {}, "plateau_angle": {}}, "packings": self.packings,
            "engines": list(self.engines), "rows": rows, "tables": {},
        }
        (self.folder / "accuracy.json").write_text(json.dumps(data))
        if self.effects is not None:
            (self.folder / "effects.json").write_text(json.dumps(self._effects(plain)))
        return self.folder

    def _rows(self, engine, name):
        knob = KNOBS[type(self.scene)][name]
        common = {
            "knob": name, "knob_value": knob.value, "engine": engine, "quantity": "friction_angle", "unit": "deg",
            "scale": SCALE, "spread": self.spread, "floor": self.spread / self.packings**0.5,
        }
        for value, (error, bar, seconds) in self.knobs[name].items():
            yield common | {
                "kind": "measured", "value": value, "setting": f"{value:g}", "x": knob.x(value), "status": "completed",
                "declared": value == self.own[name], "signed_error": error, "error_bar": bar,
                "cpu_seconds": seconds * self.dearer.get(engine, 1.0), "each": self._each(name, value),
                "beyond_limit": self.largest if name == "dt" and self.largest and value > self.largest else None,
            }
        order = None if math.isnan(self.order) else self.order
        yield common | {"kind": "extrapolated", "state": self.state, "order_used": order, "error_bar": 0.0}

    def _each(self, name, value):
        """Two packings whose standard deviation is the spread, of samples that go with 1/sqrt(N)."""
        size = (self.own[name] / value) ** 0.5 if name == "size" else 1.0
        half = self.spread * size * SCALE / 2**0.5
        return [SCALE - half, SCALE + half]

    def _effects(self, plain):
        row = {"trial": 1, "quantity": "friction_angle", "change (%)": self.effects["change"],
               "standard error (%)": self.effects["error"]}
        return {
            "scene": plain, "quantities": ["friction_angle"], "tolerance": 0.05, "tables": {"trials": [row]},
            "left_out": list(self.effects["names"]), "saved": self.effects["saved"],
        }


@pytest.fixture
def study(tmp_path):
    return lambda knobs, **more: Study(tmp_path, knobs, **more)


@pytest.fixture
def file():
    return FILE
