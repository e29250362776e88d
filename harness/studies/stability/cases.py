"""The hard cases: scene files with a table `expect`, found, read and checked."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from harness.errors import InputError
from harness.scene.describe import nearest
from harness.scene.expect import Expect, Invariant
from harness.scene.files import read_text
from harness.scene.load import LARGEST_FILE, load_scene
from harness.scene.model import Scene
from harness.studies.stability.invariants import KINDS
from harness.studies.stability.topics import TOPICS


@dataclass(frozen=True, kw_only=True)
class Case:
    """One hard case. scene: None when the scene is refused, as it must be; refusal: the line that says so."""

    name: str
    file: Path
    expect: Expect
    title: str
    scene: Scene | None
    refusal: str = ""

    @property
    def invariants(self) -> tuple[Invariant, ...]:
        """What is declared and, without being declared, what every run must have."""
        named = {i.name for i in self.expect.invariants}
        always = ALWAYS if ALONE in named else (*ALWAYS, MEETS)
        return (*(i for i in always if i.name not in named), *self.expect.invariants)

    @property
    def twins(self) -> tuple[str, ...]:
        """Names of the cases whose runs this one is held against."""
        return tuple(dict.fromkeys(i.twin.case for i in self.expect.invariants if i.twin is not None))


ALWAYS = (
    Invariant(name="finite", tolerance=0.0, reason="every recorded number is one"),
    Invariant(name="contained", tolerance=0.0, reason="no particle is lost or behind a wall"),
)

MEETS = Invariant(name="meets", tolerance=0.0, reason="a case without a contact tests none")
ALONE = "free_flight"
"""The invariant of cases in which nothing is to touch."""


def shipped_folder() -> Path:
    """Return the folder of the shipped hard cases."""
    return Path(__file__).resolve().parents[3] / "inputs" / "hard_cases"


def all_cases(folder: Path | None = None) -> tuple[Case, ...]:
    """Return all hard cases of a folder, by name. Raises InputError for a wrong one, and for no case at all."""
    folder = shipped_folder() if folder is None else folder
    files = sorted(folder.glob("*.toml"))
    if not files:
        raise InputError(file=folder, expected="hard cases (*.toml)", got="none")
    cases = tuple(read_case(file) for file in files)
    _check_twins(cases)
    return cases


def choose_cases(cases: Sequence[Case], names: Sequence[str], *, long: bool) -> tuple[Case, ...]:
    """Return the named cases, or the standard set: all that are not long, unless `long` asks for those too.

    What is no name of a case can be a topic. Raises InputError for what is neither.
    """
    if not names:
        return tuple(c for c in cases if long or not c.expect.long)
    known = [*(c.name for c in cases), *TOPICS]
    unknown = next((n for n in names if n not in known), None)
    if unknown is not None:
        raise InputError(
            file="stability", expected="names of hard cases or of their topics", got=unknown,
            fix=nearest(unknown, known) or "grainproof stability --list names them",
        )
    topics = set(names) - {c.name for c in cases}
    return tuple(c for c in cases if c.name in names or topics & set(c.expect.topics))


def with_twins(chosen: Sequence[Case], cases: Sequence[Case]) -> tuple[Case, ...]:
    """Return the chosen cases and those that they are held against, in the order of all."""
    wanted = {c.name for c in chosen} | {name for c in chosen for name in c.twins}
    return tuple(c for c in cases if c.name in wanted)


def read_case(file: Path) -> Case:
    """Read one hard case. Raises InputError for what is wrong with it, also when a wrong scene is not refused."""
    expect, title = _expectation(file)
    scene, refusal = _scene(file, expect)
    _check_names(file, expect)
    return Case(name=file.stem, file=file, expect=expect, title=title, scene=scene, refusal=refusal)


def _expectation(file: Path) -> tuple[Expect, str]:
    """Return the table `expect` and the title, of a scene that may be one to be refused."""
    try:
        data = tomllib.loads(read_text(file, what="a hard case (TOML)", largest=LARGEST_FILE))
        return msgspec.convert(data["expect"], Expect), str(data.get("title", file.stem))
    except KeyError:
        raise InputError(file=file, place="expect", expected="a table: this is a hard case", got="nothing") from None
    except (msgspec.ValidationError, tomllib.TOMLDecodeError):
        load_scene(file)  # says in one line what is wrong, and where
        raise


def _scene(file: Path, expect: Expect) -> tuple[Scene | None, str]:
    """Load the scene, or have it refused for the reason that is declared."""
    if expect.refused is None:
        return load_scene(file), ""
    try:
        load_scene(file)
    except InputError as error:
        return None, str(error).removeprefix(f"{file}: ")
    return None, ""


def _check_names(file: Path, expect: Expect) -> None:
    for k, invariant in enumerate(expect.invariants):
        if invariant.name not in KINDS:
            raise InputError(
                file=file, place=f"expect.invariants[{k}].name", expected=f"one of {', '.join(KINDS)}",
                got=invariant.name, fix=nearest(invariant.name, KINDS),
            )
        if KINDS[invariant.name].twins != (invariant.twin is not None):
            expected = "a table" if KINDS[invariant.name].twins else "no table"
            raise InputError(
                file=file, place=f"expect.invariants[{k}].twin", expected=f"{expected} for {invariant.name}",
                got="a table" if invariant.twin else "nothing",
            )
    for topic in expect.topics:
        if topic not in TOPICS:
            raise InputError(
                file=file, place="expect.topics", expected=f"words out of {', '.join(TOPICS)}", got=topic,
                fix=nearest(topic, TOPICS),
            )


def _check_twins(cases: Sequence[Case]) -> None:
    names = {c.name for c in cases if c.scene is not None}
    for case in cases:
        for name in case.twins:
            if name not in names:
                raise InputError(
                    file=case.file, place="expect.invariants.twin.case", expected="the name of a hard case that runs",
                    got=name, fix=nearest(name, names),
                )
