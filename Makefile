# Two commands: `make run` (the main job) and `make test`. Both set up what they need.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= out

.PHONY: run test test-long setup liggghts clean

run: setup
	$(BIN)/grainproof compare inputs/scenes/biaxial.toml --out $(OUT)/biaxial

test: setup
	$(BIN)/ruff check .
	$(BIN)/lint-imports
	$(BIN)/python -m pytest -n 2 -m "not long"

test-long: setup
	$(BIN)/python -m pytest -m long

setup: $(VENV)/installed liggghts

$(VENV)/installed: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "grainproof needs Python 3.11 or newer: make PYTHON=/path/to/python3.11")'
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || { $(AS_ROOT) && $(APT) python3-venv >/dev/null; } || \
	  { echo "Python's venv is missing (as root: apt-get install -y python3-venv)"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@

# Debian's LIGGGHTS is the third engine; without it everything runs with two.
AS_ROOT := [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null
APT := apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends
HOW := apt-get install -y --no-install-recommends liggghts
liggghts:
	@command -v liggghts >/dev/null || \
	if $(AS_ROOT); then echo "installing Debian's liggghts"; \
	  { $(APT) liggghts; } >/dev/null 2>&1 || echo "liggghts could not be installed: going on without it ($(HOW))"; \
	else echo "liggghts is not here: going on without it (as root: $(HOW))"; fi

clean:
	rm -rf $(VENV) $(OUT) *.egg-info .pytest_cache .ruff_cache .import_linter_cache
