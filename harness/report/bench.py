"""The bench report: tables for the terminal, and the same numbers as CSV, JSON, a picture and a page."""

from __future__ import annotations

import shlex
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.report.page import Figure, Section, render_page
from harness.report.tables import Answer, csv_text
from harness.studies.bench.measure import SAME
from harness.studies.bench.packing import TILE
from harness.studies.bench.statistics import LEAST_COUNT, Spread, exponent, growth, ratio, spread
from harness.studies.bench.study import OUT_OF_TIME

if TYPE_CHECKING:
    from harness.studies.bench.study import Bench, Cell

TITLE = "Speed: the kernel against the codes"

RATIO_NOTE = (
    "CPU time per step of the kernel over that of each code on the same packing and the same physics: below 1 the "
    "kernel is faster. Ratios are taken within a round, in which all codes make some steps one after the other on "
    "one core; given are the median and, in brackets, least and largest over the rounds. Set-up is not part of it; "
    "renewals of pair lists are, where they fall into a round. Every code lists pairs to the same distance and writes "
    "nothing. How each computes stands under Machine."
)
EFFECT_NOTE = (
    "CPU time per step of the kernel in a case over that in the case it is compared with, which has one effect less "
    "or another; both ran in the same rounds."
)
TIME_NOTE = "Median over the rounds, CPU time. On a shared machine these vary more than the ratios do."
EXPONENT_NOTE = (
    f"p in t ~ N^p by least squares over the sizes from N = {LEAST_COUNT}, with its standard error; at least three."
)
MEMORY_NOTE = (
    "held, peak: what NumPy and Python allocate for a kernel by tracemalloc, at the largest size, over N; peak with "
    "the set-up. resident: growth of the process from one size to another, least squares over the sizes from "
    f"N = {LEAST_COUNT}, so that libraries do not count; the allocator's own slack does."
)
PROBLEM_NOTE = (
    "Packings are disordered, just above jamming, brought to rest by the kernel: spheres at every size, discs up to "
    f"N = {TILE}; larger ones of discs are put together of mirror images (with periodic axes: repetitions) of one of "
    f"{TILE}, whose seams are then relaxed. Particles have one mass. off: rms distance of a code's positions from the "
    f"kernel's after the first steps, over the rms displacement; a code that is further off than {SAME:g} solves "
    "another problem and is not listed as timed. steps a rebuild: of the kernel's pair list. took: on the "
    "clock, with packing and set-up."
)


def bench_answer(bench: Bench) -> Answer:
    """Return tables for people and everything for programs."""
    titles = {
        "machine": "Machine", "ratios": f"CPU time per step, {bench.kernel} over each code: median (range) over rounds",
        "effects": f"CPU time per step of the {bench.kernel}: a case over another",
        "times": "CPU time per step (us)", "exponents": "Cost ~ N^p: p +- standard error",
        "memory": "Memory (bytes a particle)", "problems": "Packings", "not_timed": "Not timed",
    }
    shown = shown_tables(bench)
    return Answer(tables={title: shown[name] for name, title in titles.items()}, data=bench_data(bench))


def write_bench(bench: Bench, out: Path) -> Path:
    """Write bench.html, bench.json, bench.png and CSV tables into `out`; return the page."""
    from harness.report.bench_figure import bench_figure
    from harness.report.figures import png_bytes, png_uri
    from harness.runs.atomic import write_bytes_atomic, write_json_atomic, write_text_atomic

    out.mkdir(parents=True, exist_ok=True)
    for name, rows in exact_tables(bench).items():
        write_text_atomic(out / f"{name}.csv", csv_text(rows))
    figure = bench_figure(bench)
    sections = _sections(bench, () if figure is None else (Figure(uri=png_uri(figure), caption=CAPTION),), out)
    if figure is None:
        (out / "bench.png").unlink(missing_ok=True)
    else:
        write_bytes_atomic(out / "bench.png", png_bytes(figure, dpi=110))
    write_json_atomic(out / "bench.json", bench_data(bench))
    write_text_atomic(out / "bench.html", render_page(title=TITLE, lead=f"{summary(bench)}.", sections=sections))
    return out / "bench.html"


CAPTION = (
    "Above: CPU time per step against the number of particles, medians. Below: the kernel's time over that of each "
    "code, median and range over the rounds."
)


def summary(bench: Bench) -> str:
    """Return one line: how much was timed, where, by whom."""
    late = f" of {len(bench.cells) + len(bench.left_out)}, then time was up" if bench.left_out else ""
    where = "not pinned" if bench.core is None else f"pinned to core {bench.core}"
    return (
        f"{len(bench.cells)} cells{late}, {bench.effort.rounds} interleaved rounds each, {where} of "
        f"{bench.host.cpu_model}; {', '.join(bench.versions)} took part"
    )


def bench_data(bench: Bench) -> dict:
    """Return all tables with all digits, every round, and the machine."""
    from msgspec import to_builtins

    return {
        "quick": bench.quick, "exit_status": bench.exit_status, "host": to_builtins(bench.host), "core": bench.core,
        "versions": bench.versions, "notes": bench.notes, "effort": asdict(bench.effort), "tables": exact_tables(bench),
    }


def shown_tables(bench: Bench) -> dict[str, list[dict]]:
    """Return rows by table for people: a ratio is one cell."""
    exact = exact_tables(bench)
    return {
        "machine": machine_rows(bench), "ratios": [_ratio_row(bench, c) for c in bench.cells],
        "effects": [_effect_row(r) for r in exact["effects"]], "times": [_time_row(bench, c) for c in bench.cells],
        "exponents": exact["exponents"], "problems": [_readable(r) for r in exact["problems"]],
        "memory": [_readable(r) for r in exact["memory"]],
        "not_timed": exact["not_timed"],
    }


def exact_tables(bench: Bench) -> dict[str, list[dict]]:
    """Return rows by table, one number a cell."""
    return {
        "ratios": [r for c in bench.cells for r in _ratio_rows(bench, c)],
        "effects": [r for c in bench.cells for r in _effect_rows(bench, c)],
        "rounds": [r for c in bench.cells for r in _round_rows(c)],
        "exponents": exponent_rows(bench), "memory": memory_rows(bench),
        "problems": [_problem_row(bench, c) for c in bench.cells], "not_timed": not_timed_rows(bench),
    }


# --- rows ----------------------------------------------------------------------------------------


def machine_rows(bench: Bench) -> list[dict]:
    """One row a fact about the machine and the codes."""
    loads = [c.load for c in bench.cells]
    busy = f"{min(loads):.2g} to {max(loads):.2g}" if loads else None
    facts = {
        "CPU": bench.host.cpu_model, "cores": bench.host.cores, "pinned to core": bench.core,
        "runnable processes meanwhile": busy, "Python, NumPy": f"{bench.host.python}, {bench.host.numpy}",
        "rounds": bench.effort.rounds, "CPU time of a round and code, about (s)": bench.effort.seconds,
        **{name: f"{bench.versions.get(name, 'not here')}; {note}" for name, note in bench.notes.items()},
    }
    return [{"what": name, "value": value} for name, value in facts.items()]


def exponent_rows(bench: Bench) -> list[dict]:
    """One row a case and code with enough sizes."""
    rows = []
    for case, label, cells in _by_case(bench):
        found = exponent([c.count for c in cells], [_median(c, label) for c in cells])
        if found is not None:
            rows.append({"case": case, "code": label, "p": found.value, "+-": found.error, "sizes": found.sizes})
    return rows


def memory_rows(bench: Bench) -> list[dict]:
    """One row a case and code of which something is known."""
    rows = []
    for case, label, cells in _by_case(bench):
        facts, largest = [c.tracks[label].facts for c in cells], cells[-1].count
        grown = [(c.count, f["resident"]) for c, f in zip(cells, facts, strict=True) if "resident" in f]
        known = {"held": facts[-1].get("held"), "peak": facts[-1].get("peak")}
        known = {k: None if v is None else v / largest for k, v in known.items()}
        resident = growth([n for n, _ in grown], [b for _, b in grown])
        if resident is not None or known["held"] is not None:
            rows.append({"case": case, "code": label, "N": largest, **known, "resident": resident})
    return rows


def not_timed_rows(bench: Bench) -> list[dict]:
    """One row a reason: whole cases that the kernel skips, and codes that are missing from cells."""
    rows = [{"case": c, "code": "all", "status": "skipped", "N": None, "reason": r} for c, r in bench.skipped.items()]
    late: dict[str, list[int]] = {}
    for case, count in bench.left_out:
        late.setdefault(case, []).append(count)
    rows += [
        {"case": case, "code": "all", "status": "left out", "N": ", ".join(map(str, counts)), "reason": OUT_OF_TIME}
        for case, counts in late.items()
    ]
    missing: dict[tuple[str, str, str, str], list[int]] = {}
    for cell in bench.cells:
        for label, track in cell.tracks.items():
            if track.status != "timed":
                missing.setdefault((cell.case.name, label, track.status, track.reason), []).append(cell.count)
    return rows + [
        {"case": case, "code": label, "status": status, "N": ", ".join(map(str, counts)), "reason": reason}
        for (case, label, status, reason), counts in missing.items()
    ]


def _ratio_row(bench: Bench, cell: Cell) -> dict:
    row = {"case": cell.case.name, "N": cell.count, f"{bench.kernel} (us)": _microseconds(cell, bench.kernel)}
    return _readable(row) | {label: _said(_ratio(cell, bench.kernel, label)) for label in bench.others}


def _ratio_rows(bench: Bench, cell: Cell) -> list[dict]:
    found = {label: _ratio(cell, bench.kernel, label) for label in bench.others}
    return [
        {"case": cell.case.name, "N": cell.count, "over": label, **_numbers(s)} for label, s in found.items() if s
    ]


def _effect_rows(bench: Bench, cell: Cell) -> list[dict]:
    label = f"{bench.kernel}, {cell.case.base}"
    found = _ratio(cell, bench.kernel, label) if label in cell.tracks else None
    return [{"case": cell.case.name, "over": cell.case.base, "N": cell.count, **_numbers(found)}] if found else []


def _effect_row(row: dict) -> dict:
    said = _said(Spread(row["median"], row["low"], row["high"]))
    return {"case": row["case"], "over": row["over"], "N": row["N"], "ratio": said}


def _time_row(bench: Bench, cell: Cell) -> dict:
    times = {label: _microseconds(cell, label) for label in (bench.kernel, *bench.others)}
    return _readable({"case": cell.case.name, "N": cell.count, **times})


def _round_rows(cell: Cell) -> list[dict]:
    return [
        {"case": cell.case.name, "N": cell.count, "code": label, "round": k + 1, "steps": track.steps,
         "CPU per step (us)": 1e6 * float(seconds)}
        for label, track in cell.tracks.items() for k, seconds in enumerate(track.seconds)
    ]


def _problem_row(bench: Bench, cell: Cell) -> dict:
    track, packing = cell.tracks[bench.kernel], cell.packing
    off = {f"{label} off": cell.tracks[label].off if label in cell.tracks else None for label in bench.others}
    rebuilds = track.facts.get("rebuilds")
    return {
        "case": cell.case.name, "N": cell.count, "fraction": packing.fraction, "contacts a particle": packing.contacts,
        "unbalanced": packing.unbalanced, "steps a round": track.steps,
        "steps a rebuild": cell.steps_made / rebuilds if rebuilds else None, **off, "took (s)": cell.seconds,
    }


def _by_case(bench: Bench):
    """Yield case, label and the cells in which the label was timed, by ascending size."""
    for case in dict.fromkeys(c.case.name for c in bench.cells):
        cells = sorted((c for c in bench.cells if c.case.name == case), key=lambda c: c.count)
        for label in (bench.kernel, *bench.others):
            timed = [c for c in cells if label in c.tracks and c.tracks[label].status == "timed"]
            if timed:
                yield case, label, timed


def _sections(bench: Bench, figures: tuple[Figure, ...], out: Path) -> list[Section]:
    shown = shown_tables(bench)
    return [
        Section(heading="Kernel over each code", note=RATIO_NOTE, rows=shown["ratios"], figures=figures),
        Section(heading="What an effect costs", note=EFFECT_NOTE, rows=shown["effects"]),
        Section(heading="CPU time per step (us)", note=TIME_NOTE, rows=shown["times"]),
        Section(heading="How cost grows", note=EXPONENT_NOTE, rows=shown["exponents"]),
        Section(heading="Memory (bytes a particle)", note=MEMORY_NOTE, rows=shown["memory"]),
        Section(heading="Packings", note=PROBLEM_NOTE, rows=shown["problems"]),
        Section(heading="Not timed", rows=shown["not_timed"]),
        Section(heading="Machine", rows=shown["machine"]),
        Section(heading="Reproduce", text=_command(bench, out)),
    ]


def _command(bench: Bench, out: Path) -> str:
    return shlex.join(["grainproof", "bench", *(["--quick"] if bench.quick else []), "--out", str(out)])


def _ratio(cell: Cell, label: str, other: str) -> Spread | None:
    if label not in cell.tracks or other not in cell.tracks:
        return None
    return ratio(cell.tracks[label].seconds, cell.tracks[other].seconds)


def _median(cell: Cell, label: str) -> float:
    return spread(cell.tracks[label].seconds).median


def _microseconds(cell: Cell, label: str) -> float | None:
    timed = label in cell.tracks and len(cell.tracks[label].seconds)
    return 1e6 * float(np.median(cell.tracks[label].seconds)) if timed else None


def _readable(row: dict) -> dict:
    """Write numbers from 1000 as whole ones: three digits would be an exponent."""
    return {k: round(v) if isinstance(v, float) and abs(v) >= 1000.0 else v for k, v in row.items()}


def _numbers(s: Spread) -> dict[str, float]:
    return {"median": s.median, "low": s.low, "high": s.high}


def _said(s: Spread | None) -> str | None:
    return None if s is None else f"{s.median:.2f} ({s.low:.2f}-{s.high:.2f})"
