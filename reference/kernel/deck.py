"""The kernel's own deck: `kernel.json` (walls, laws, numerics) and `particles.csv`, one folder a run.

With rings also `rings.csv`: a line for every glued disc. With `materials` (their words) the numbers of laws are tables
over pairs of them, particles have a column and walls a key `material`: a number, from 0 on.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reference.kernel.conventions import NAMED, Convention
from reference.kernel.laws.law import Law
from reference.kernel.laws.registry import LAWS, build_law
from reference.kernel.model import Constant, Cosine, Fixed, Loaded, Model, Ring, Wall
from reference.kernel.origin import near_origin

DECK, PARTICLES, RINGS = "kernel.json", "particles.csv", "rings.csv"
RING_COLUMNS = ("ring", "x", "y", "radius")
"""Of `rings.csv`; ring: the number of the disc's ring among those of `kernel.json`, from 1 on."""
_MOTIONS = {"fixed": Fixed, "cosine": Cosine, "constant": Constant, "loaded": Loaded}


@dataclass(frozen=True, kw_only=True)
class Plan:
    """How long to run and what to write; sample_every and frame_every divide steps."""

    steps: int
    sample_every: int
    frame_every: int
    contacts: bool


def particle_columns(dimension: int) -> list[str]:
    """Return the header of `particles.csv`."""
    axes = "xyz"[:dimension]
    spins = ["wz"] if dimension == 2 else ["wx", "wy", "wz"]
    return ["id", *axes, "radius", "mass", "inertia", *(f"v{a}" for a in axes), *spins]


def read_deck(folder: Path) -> tuple[Model, Plan]:
    """Return the problem, told from its middle if that is far from the origin, and the plan of a run folder."""
    deck = json.loads((folder / DECK).read_text())
    columns = particle_columns(deck["dimension"]) + ["material"] * ("materials" in deck)
    glued = _columns(folder / RINGS, RING_COLUMNS) if "rings" in deck else {}
    model = _model(deck, _columns(folder / PARTICLES, columns), glued)
    return near_origin(model), Plan(**deck["plan"])


def _columns(path: Path, names: Sequence[str]) -> dict[str, np.ndarray]:
    table = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    if table.shape[1] != len(names):
        raise ValueError(f"{path.name}: expected columns {','.join(names)}, got {table.shape[1]} columns")
    return dict(zip(names, table.T, strict=True))


def _model(deck: dict, p: dict[str, np.ndarray], glued: dict[str, np.ndarray]) -> Model:
    axes = "xyz"[: deck["dimension"]]
    spins = ["wz"] if deck["dimension"] == 2 else ["wx", "wy", "wz"]
    convention = NAMED[deck["convention"]]
    return Model(
        x=np.stack([p[a] for a in axes]),
        v=np.stack([p[f"v{a}"] for a in axes]),
        spin=np.stack([p[w] for w in spins]),
        radius=p["radius"].copy(),
        mass=p["mass"].copy(),
        inertia=p["inertia"].copy(),
        walls=tuple(_wall(w) for w in deck["walls"]),
        **_laws(deck, convention, _kinds(deck, p)),
        convention=convention,
        dt=deck["dt"],
        gravity=_tuple(deck.get("gravity")),
        drag=deck.get("drag"),
        periodic=_tuple(deck.get("periodic")),
        rotations=deck.get("rotations", False),
        rings=tuple(_ring(ring, number, glued) for number, ring in enumerate(deck.get("rings", ()), start=1)),
    )


def _kinds(deck: dict, p: dict[str, np.ndarray]) -> np.ndarray | None:
    """The number of each node's material, (nodes,), from 0 on; None without materials. Raises ValueError with rings."""
    if "materials" not in deck:
        return None
    if "rings" in deck:
        raise ValueError("materials: expected a deck without rings, whose discs are of none")
    return np.concatenate([p["material"], [w["material"] for w in deck["walls"]]]).astype(np.intp)


def _laws(deck: dict, convention: Convention, kind: np.ndarray | None) -> dict[str, Law | None]:
    """The laws of all families; None for what the deck does not name."""
    normal = build_law("normal", deck["normal"], convention, kind=kind)
    tangential = [family for family in LAWS if family != "normal"]
    named = {family: deck.get(family) for family in tangential}
    made = {k: None if table is None else build_law(k, table, convention, normal, kind) for k, table in named.items()}
    return {"normal": normal, **made}


def _wall(deck: dict) -> Wall:
    motion = {k: _tuple(v) for k, v in deck["motion"].items() if k != "kind"}
    return Wall(
        name=deck["name"], point=tuple(deck["point"]), normal=tuple(deck["normal"]), friction=deck["friction"],
        motion=_MOTIONS[deck["motion"]["kind"]](**motion),
    )


def _ring(deck: dict, number: int, glued: dict[str, np.ndarray]) -> Ring:
    mine = glued["ring"] == number
    return Ring(
        name=deck["name"], centre=tuple(deck["centre"]), x=np.stack([glued["x"][mine], glued["y"][mine]]),
        radius=glued["radius"][mine], omega=deck.get("omega"), circle=deck["circle"],
    )


def _tuple(value):
    return tuple(value) if isinstance(value, list) else value
