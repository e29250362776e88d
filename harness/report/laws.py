"""The report of the laws study: matrices, codes against each other, what differs and why; page, CSV, JSON, figures."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from harness.report import figures
from harness.report.law_figures import draw_curves_page, draw_matrix
from harness.report.law_tables import (
    LEGEND,
    check_rows,
    collision_rows,
    direct_rows,
    exit_rows,
    failed_rows,
    invariance_rows,
    missing_rows,
    prescribed_rows,
    reach_rows,
    reason_rows,
    short_exit_rows,
    short_frame_rows,
    summary,
    tables,
)
from harness.report.page import Figure, Section, render_page
from harness.report.tables import Answer, csv_text

if TYPE_CHECKING:
    from harness.studies.laws import LawsResult
    from harness.studies.laws.frame_checks import FrameCheck

TITLE = "Contact laws, proven in every code that has them"

PARTS, LONGEST = "parts", 80
"""Folder of reports about some laws or some engines, and the most characters of a name in it."""


@dataclass(frozen=True, kw_only=True)
class Written:
    """The files of a report."""

    page: Path
    picture: Path


def laws_answer(result: LawsResult) -> Answer:
    """Return the matrices, exit values and what differs for people, and everything for programs."""
    tables = {
        "Prescribed motion: codes against the kernel in their conventions, kernels against closed forms, codes against "
        "each other": prescribed_rows(result),
        "Collisions: codes against the kernel in their conventions, and against each other": collision_rows(result),
    }
    if result.exits:
        tables["Single impacts against closed forms"] = short_exit_rows(result)
    failed, wrong = failed_rows(result), check_rows(c for c in result.checks if c.verdict == "differs")
    if failed:
        tables["What failed"] = failed
    if wrong:
        tables["What differs"] = wrong
    return Answer(tables=tables, data=laws_data(result))


def closing_words(result: LawsResult, written: Written) -> str:
    """Return what is said at the end: what marks mean, the summary, where the report is."""
    part = "" if result.whole else " (of a part; a report on all laws and engines is not touched)"
    return f"{LEGEND}\n{summary(result)}\nreport: {written.page}{part}"


def write_laws_report(result: LawsResult, out: Path) -> Written:
    """Write laws.html, laws.json, laws.png and CSV tables below `out`; each whole or not at all.

    A report on some laws or some engines goes into a folder of its own: it never takes the place of the whole one.
    """
    from harness.runs.atomic import write_bytes_atomic, write_json_atomic, write_text_atomic

    out = out if result.whole else out / PARTS / part_name(result)
    out.mkdir(parents=True, exist_ok=True)
    matrix, curves = draw_matrix(result), draw_curves_page(result)
    for name, rows in tables(result).items():
        write_text_atomic(out / f"laws_{name}.csv", csv_text(rows))
    write_json_atomic(out / "laws.json", laws_data(result))
    write_bytes_atomic(out / "laws.png", figures.png_bytes(matrix, dpi=110))
    page = render_page(title=TITLE, lead=f"{summary(result)}.", sections=_sections(result, matrix, curves))
    write_text_atomic(out / "laws.html", page)
    return Written(page=out / "laws.html", picture=out / "laws.png")


def part_name(result: LawsResult) -> str:
    """Return a name for a part of the study, the same for the same laws and engines."""
    laws, engines = [each.name for each in result.laws], [e.replace(":", "-") for e in result.engines]
    words = ["all" if result.has_all_laws else ",".join(laws), "all" if result.has_all_engines else ",".join(engines)]
    name = "_".join(words)
    if len(name) <= LONGEST:
        return name
    return f"{len(laws)}-laws_{len(engines)}-engines_{hashlib.sha256(name.encode()).hexdigest()[:8]}"


def laws_data(result: LawsResult) -> dict:
    """Everything as JSON-able data."""
    import msgspec

    laws = {each.name: {k: msgspec.to_builtins(v) for k, v in each.tables().items() if v} for each in result.laws}
    return {
        "summary": summary(result), "exit_status": result.exit_status, "versions": result.versions, "laws": laws,
        "prescribed": [asdict(c) for c in result.prescribed], "collisions": [asdict(c) for c in result.collisions],
        "codes": direct_rows(result), "friction": [asdict(r) for r in result.reaches], "exits": exit_rows(result),
        "failed": failed_rows(result), "checks": [asdict(c) for c in result.checks],
    }


# --- the page --------------------------------------------------------------------------------------

MATRIX_NOTE = (
    "Largest deviation over all motions (normal cycles, shear, oblique loading, rolling, twisting, everything at "
    "once), frames (turned, in translation, mirrored, relabelled, in rotation), pairs and planes, 2D and 3D: force "
    "over the largest force, torque over the largest torque of the motion. A code is compared with the kernel in its "
    "own conventions, a kernel with closed forms (a code too, where the kernel lacks the law). Closed forms are those "
    "of the engine's own convention: where slip is measured, what Coulomb's limit cuts. Agreement says that an engine "
    "computes what it is known to compute, not that two codes compute the same; what they differ by is the "
    "last column, of the plain frame, and the next table."
)
DIRECT_NOTE = (
    "How far the codes are apart in the plain frame, motion by motion, relative to the largest force or torque; of "
    "whole collisions places, velocities, spins. This is what their conventions differ by: the last column is how far "
    "the difference is from that of the closed forms (of collisions: of the two kernels)."
)
REACH_NOTE = (
    "The largest |f_t|/(mu f_n) of a pair in shear at one depth. A code that cuts spring and dashpot together carries "
    "at most mu f_n. LIGGGHTS tests the spring alone and adds the dashpot to one that sticks: it carries up to "
    "mu f_n + gamma_t |v_t|, and falls to mu f_n when the spring slides. With Mindlin's law gamma_t follows from the "
    "restitution, and at this slip of 1.1 m/s gamma_t |v_t| is 2.5 times mu f_n. That is its convention, which its "
    "closed form has too, not an error of either code; it vanishes where gamma_t |v_t| is small against mu f_n."
)
COLLISION_NOTE = (
    "Largest deviation of places, velocities and spins over whole collisions: oblique, with spin, 3D. What the kernel "
    "cannot compute (JKR holds on beyond overlap zero) is compared with an integration of its own by the same steps."
)
EXIT_NOTE = (
    "What bodies left with, of one impact each. The deviations are those of the time step; laws_exits.csv says why "
    "each tolerance is what it is."
)
INVARIANCE_NOTE = (
    "The same motion in another frame must give the same answer: the largest change where no convention depends on "
    "the frame. What is left is arithmetic in double precision: it resolves distances to 1e-16, which is 1e-14 of "
    "these overlaps and more at first touch, and a tilted plane of LIGGGHTS is a mesh, whose distance is computed from "
    "its corners. Places are rounded so that overlaps are not; in extended precision the kernel finds that the paths "
    "add less than 1e-13 of their own in 3D. "
)
FRAME_NOTE = (
    "Where a code's conventions make its answer depend on the frame, this is known: the largest change, and what the "
    "reasons lead to expect. Most predict the answer in the other frame, row by row, and it must be met to rounding: "
    "the last column. Where rounding itself decides there is a bound, and the last column is what is beyond it. "
    "laws_frames.csv has the engines apart."
)
CHECK_NOTE = "All checks with all digits are in laws_checks.csv and laws.json."


def _sections(result: LawsResult, matrix, curves) -> list[Section]:
    wrong = check_rows(c for c in result.checks if c.verdict == "differs")
    picture = Figure(uri=figures.png_uri(matrix), caption="The two matrices: the paler, the closer.")
    laws = [Figure(uri=figures.png_uri(curves), caption=CURVES)] if curves is not None else []
    made = [
        Section(heading="Prescribed motion", note=f"{MATRIX_NOTE} {LEGEND}", rows=prescribed_rows(result)),
        *_optional("What failed", "", failed_rows(result)),
        *_optional("Codes against each other", DIRECT_NOTE, direct_rows(result)),
        *_optional("What the codes differ in", "What one does / what the other does.", reason_rows(result)),
        *_optional("How much friction carries", REACH_NOTE, reach_rows(result)),
        Section(heading="Collisions", note=COLLISION_NOTE, rows=collision_rows(result)),
        Section(heading="Both at a glance", figures=(picture,)),
        *(Section(heading="The laws", figures=(figure,)) for figure in laws),
        Section(heading="Single impacts against closed forms", note=EXIT_NOTE, rows=short_exit_rows(result)),
        Section(heading="What differs", note=CHECK_NOTE, rows=wrong),
        Section(heading="In other frames", note=INVARIANCE_NOTE + above_asked(result), rows=invariance_rows(result)),
        Section(heading="What depends on the frame, and why", note=FRAME_NOTE, rows=short_frame_rows(result)),
        Section(heading="What an engine does not compute", rows=missing_rows(result)),
    ]
    versions = "\n".join(f"{engine}: {version or 'not here'}" for engine, version in result.versions.items())
    return [*made, Section(heading="Versions", text=versions)]


def _optional(heading: str, note: str, rows: list[dict]) -> list[Section]:
    """A section if there is anything in it."""
    return [Section(heading=heading, note=note, rows=rows)] if rows else []


ASKED = 1e-13
"""Frame invariance that is asked for in 3D."""


def above_asked(result: LawsResult) -> str:
    """Return in which frames answers of 3D change by more than ASKED, by engine, and by how much at most."""
    checks = _invariant(result)
    if not checks:
        return "No frame could be compared in 3D."
    above: dict[str, list[float]] = {}
    for c in checks:
        if not c.deviation <= ASKED:
            above.setdefault(f"{c.left}, {c.why.removeprefix('largest in ')}", []).append(c.deviation)
    found = "; ".join(f"{where}, {len(sizes)} motions, at most {max(sizes):.1e}" for where, sizes in above.items())
    rest = max((c.deviation for c in checks if c.deviation <= ASKED), default=None)
    head = f"Above {ASKED:g} in 3D: {found or 'nothing'}"
    return f"{head}; all else in 3D changes by at most {rest:.1e}." if rest is not None else f"{head}."


def _invariant(result: LawsResult) -> list[FrameCheck]:
    from harness.studies.laws.frame_checks import FrameCheck

    return [c for c in result.checks if isinstance(c, FrameCheck) and not c.reason and c.dimension == 3]


CURVES = (
    "What a pair of unequal bodies answers: above normal force against overlap in the normal cycles, below friction "
    "against slip at one depth, back and forth. Lines that cover each other are equal; a kernel is left out where the "
    "code whose conventions it follows is drawn. Peaks of LIGGGHTS above the others are dashpots on springs that stick."
)
