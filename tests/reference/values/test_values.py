"""The table of reference values: well formed, and strict about what it takes."""

import pytest

from reference.values import KINDS, Published, collect, published_values

TABLE = """
[plateau]
quantity = "plateau sigma_zz"
value = 183.0
unit = "N/m"
kind = "published"
origin = "a talk"
seen = true
conditions = "mu = 0"
"""


def test_shipped_values_say_where_they_come_from():
    values = published_values()
    assert values["talk_frictionless_100"].value == 183.0
    assert values["talk_frictionless_100"].unit == "N/m"
    for name, value in values.items():
        assert value.name == name
        assert value.kind in KINDS
        assert value.origin
        assert value.conditions


def test_only_seen_values_decide():
    (seen,) = collect([TABLE]).values()
    (recalled,) = collect([TABLE.replace("seen = true", "seen = false")]).values()
    assert isinstance(seen, Published)
    assert seen.decides
    assert not recalled.decides


@pytest.mark.parametrize(("change", "error"), [
    (('kind = "published"', 'kind = "guessed"'), ValueError),
    (("value = 183.0", "value = nan"), ValueError),
    (("value = 183.0", "value = 0.0"), ValueError),
    (("seen = true\n", ""), TypeError),
    (("seen = true", "seen = true\nsure = true"), TypeError),
])
def test_a_table_that_is_wrong_is_refused(change, error):
    with pytest.raises(error):
        collect([TABLE.replace(*change)])


def test_a_name_stands_for_one_value():
    assert len(collect([TABLE, TABLE.replace("[plateau]", "[other]")])) == 2
    with pytest.raises(ValueError, match="plateau: there are two"):
        collect([TABLE, TABLE])
