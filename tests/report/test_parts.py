"""Which systems a level holds in, in words."""

from harness.report.asked import ordinary_cases, periodic, walled
from harness.report.parts import Judged, levels_in_words


def said(level_of):
    return levels_in_words([Judged(system, level_of(system)) for system in ordinary_cases()])


def test_one_level_is_one_word():
    assert said(lambda _: "known_wrong") == "known wrong"
    assert levels_in_words([]) is None


def test_the_factor_that_decides_is_named():
    assert said(lambda s: "partial" if s.dimension == 3 else "exact") == "exact, but partial in 3D"
    assert said(lambda s: "exact" if s.walls else "unsupported") == "exact, but unsupported in a periodic box"
    rolls = said(lambda s: "exact" if s.rolling is None else "partial")
    assert rolls == "exact, but partial with spring rolling or with constant rolling"


def test_two_factors_are_named_where_one_does_not_decide():
    both = said(lambda s: "partial" if s.dimension == 3 and s.walls else "exact")
    assert both == "exact, but partial in 3D between walls"
    either = said(lambda s: "partial" if s.dimension == 3 or s.walls else "exact")
    assert either == "exact, but partial between walls or in 3D"


def test_what_nothing_here_decides_is_a_list_from_best_to_worst():
    torn = [Judged(walled(2), "unsupported"), Judged(walled(2), "exact"), Judged(periodic(2), "partial")]
    assert levels_in_words(torn) == "exact, partial, unsupported"
