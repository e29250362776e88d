"""The examples in the docstrings hold, and every family has one."""

import doctest
import importlib
import pkgutil

import pytest

import reference.analytic

FAMILIES = [module.name for module in pkgutil.iter_modules(reference.analytic.__path__)]


@pytest.mark.parametrize("family", FAMILIES)
def test_examples(family):
    result = doctest.testmod(importlib.import_module(f"reference.analytic.{family}"))
    assert result.attempted > 0
    assert result.failed == 0
