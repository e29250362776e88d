"""The page as such: escaped, self-contained, with figures that decode."""

import base64
import io
import re

import numpy as np
import pytest

from harness.report import figures
from harness.report.page import Figure, Section, render_page

HOSTILE = "</title><script>alert(1)</script><img src=x onerror=\"alert('2')\">{{ 7*7 }}&"


def page(**section) -> str:
    return render_page(title="T", lead="L", sections=[Section(heading="H", **section)])


def test_everything_from_outside_is_escaped():
    html = render_page(title=HOSTILE, lead=HOSTILE, sections=[
        Section(heading=HOSTILE, note=HOSTILE, text=HOSTILE, rows=[{HOSTILE: HOSTILE}],
                figures=(Figure(uri="data:,", caption=HOSTILE),)),
    ])
    assert "<script" not in html
    assert "onerror=\"" not in html
    assert "49" not in re.sub(r"<style>.*</style>", "", html, flags=re.S)
    assert html.count("&lt;script&gt;") == 10
    assert html.count("<img ") == 1


def test_verdicts_have_a_look_and_other_words_have_none():
    html = page(rows=[{"a": "differs", "b": 1.5, "c": "differs\" onclick=\"x", "d": None}])
    cells = re.findall(r'<td class="([^"]*)">([^<]*)</td>', html)
    assert cells == [("differs", "differs"), ("number", "1.5"), ("", "differs&#34; onclick=&#34;x"), ("", "-")]


def test_a_table_without_rows_says_so_and_no_table_says_nothing():
    assert "<p>nothing</p>" in page(rows=[])
    assert "nothing" not in page(text="x")


def test_long_commands_are_wrapped_not_cut():
    html = render_page(title="T", lead="L", sections=[Section(heading="H", text="cd /a/long/path")])
    style = html[html.index("  pre {"):].split("}")[0]
    assert "white-space: pre-wrap; overflow-wrap: anywhere" in style
    assert "<pre>cd /a/long/path</pre>" in html


def test_figures_are_pictures_within_the_page():
    figure, axes = figures.new_figure(1, 2, width=4, height=2)
    axes[0, 0].plot([0, 1], [0, 1])
    uri = figures.png_uri(figure, dpi=50)
    assert picture(uri).shape == (100, 200, 3)  # nothing shines through, so no transparency is kept
    assert f'<img src="{uri}"' in page(figures=(Figure(uri=uri, caption="c"),))


def picture(uri: str) -> np.ndarray:
    from matplotlib.image import imread

    head, data = uri.split(",", 1)
    assert head == "data:image/png;base64"
    return imread(io.BytesIO(base64.b64decode(data, validate=True)))


def test_contact_lines_go_from_centre_to_centre_or_to_the_wall(box):
    frame = box.trajectory().frames[0]
    start, end, force = figures.contact_lines(frame)
    length = np.linalg.norm(end - start, axis=1)
    to_wall = frame.contacts["j"] < 0
    assert length[~to_wall] == pytest.approx(np.full(12, 2.0))
    assert length[to_wall] == pytest.approx(np.full(12, 1.0))
    assert force == pytest.approx(np.full(24, 0.2))


def test_growth_without_any_difference_can_be_drawn(recwarn):
    from harness.studies.compare.growth import Growth

    figure, axes = figures.new_figure(1, 1, width=3, height=2)
    figures.draw_growth(axes[0, 0], {"a - b": Growth(time=np.arange(3.0), difference=np.zeros(3))})
    figures.png_uri(figure)
    assert not [w for w in recwarn if issubclass(w.category, UserWarning)]


@pytest.mark.parametrize("scale", ["linear", "log"])
def test_a_panel_fills_its_figure_as_the_constrained_layout_would(scale):
    """One look at the labels gives the places that two do, to a pixel."""
    def drawn():
        figure, ((axes,),) = figures.new_figure(1, 1, width=4.4, height=3.1)
        axes.plot([0.1, 10.0], [1e-9, 1.0])
        axes.set(xlabel="axial strain (%)", ylabel="a long name\nin two lines", yscale=scale)
        return figure, axes

    (ours, a), (theirs, b) = drawn(), drawn()
    figures.png_bytes(ours, dpi=140)
    theirs.dpi = 140
    theirs.canvas.draw()
    assert a.get_position().bounds == pytest.approx(b.get_position().bounds, abs=1.0 / (3.1 * 140))


def test_png_and_svg_have_one_layout():
    figure, axes = figures.new_figure(2, 2, width=4, height=3)
    figures.png_bytes(figure, dpi=50)
    places = [a.get_position().bounds for a in axes.flat]
    figures.svg_bytes(figure)
    assert [a.get_position().bounds for a in axes.flat] == places


def test_a_figure_that_is_transparent_stays_so():
    figure, _ = figures.new_figure(1, 1, width=2, height=1)
    figure.patch.set_alpha(0.0)
    png = figures.data_uri(figures.png_bytes(figure, dpi=50))
    assert picture(png).shape[2] == 4
