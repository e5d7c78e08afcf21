# Needs Python 3.11, git and make; everything else goes into .venv.
#   make demo    simulate the five-bar, identify it, leave a report under results/demo
#   make test    lint, types, import rules and tests
#   make format  put the code into the shape that `make test` asks for

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint .ci/constraints.txt

.DELETE_ON_ERROR:
.PHONY: demo test lint types imports tests format constraints clean

demo: $(INSTALLED)
	@$(BIN)/bench demo

test: lint types imports tests

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(INSTALLED)
	$(BIN)/mypy

imports: $(INSTALLED)
	$(BIN)/lint-imports --no-logo

tests: $(INSTALLED)
	$(BIN)/pytest --quiet --numprocesses 2

format: $(INSTALLED)
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .

# The build backend is installed first, so that the editable install needs no build environment of its own.
$(INSTALLED): pyproject.toml .ci/constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(PIP_INSTALL) hatchling
	$(PIP_INSTALL) --no-build-isolation --editable '.[dev]'
	@touch $@

# Pin anew what the dependencies bring along, after `make clean` and a change of pyproject.toml.
constraints:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet '.[dev]'
	$(BIN)/python -m pip freeze --exclude parabench > .ci/constraints.txt

clean:
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .import_linter_cache build dist
