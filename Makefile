# Needs Python 3.11, git and make; everything else goes into .venv.
#   make demo    simulate the five-bar, identify it, leave a report under results/demo
#   make test    lint, types, import rules and tests
#   make test-kernels  the numeric tests under each kernel of OpenBLAS that the processor can execute
#   make check   the quick reference scenarios beside results/reference (make check-full: all seeds)
#   make speed   what things cost, beside the last time; history in results/speed
#   make measured  identify and diagnose measured logs, beside what is known of their machines
#   make trust  every robot and question on simulated machines with known truth, in three hours, into results/trust
#   make peers   mujoco.sysid and FIGAROH on the same problems, in an environment of their own
#   make docs    the documentation as a site, in site/; open site/index.html
#   make pictures  the pictures of the README and the tutorials, by the commands that they show, in results/pictures
#   make atlas   the figures of the atlas of effects, in results/atlas
#   make format  put the code into the shape that `make test` asks for

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
PEERS := .venv-peers
PEERS_INSTALL := $(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check \
	--constraint .ci/constraints.txt --constraint .ci/constraints-peers.txt
INSTALLED := $(VENV)/.installed
SCRIPTS := $(wildcard bench/*/assets/*.js bench/*/*/assets/*.js docs/pages/*.js)
PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint .ci/constraints.txt

.DELETE_ON_ERROR:
.PHONY: demo test lint types imports tests test-kernels check check-full speed measured trust peers docs pictures atlas format constraints clean

demo: $(INSTALLED)
	@$(BIN)/bench demo

# mypy and the import rules have one thread, and the tests wait for processes that they start: side by side they leave no
# core idle.
test: lint
	@$(MAKE) --no-print-directory --jobs 3 types imports tests

lint: $(INSTALLED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/oxlint --quiet --config .ci/oxlint.json $(SCRIPTS)
	$(BIN)/oxfmt --config .ci/oxfmt.json --list-different $(SCRIPTS)

types: $(INSTALLED)
	$(BIN)/mypy

imports: $(INSTALLED)
	$(BIN)/lint-imports --no-logo

# Compiled first, and bytecode is kept whatever the environment says of it: the commands that tests start would compile
# the package each time, and pytest rewrite the assertions of all tests.
tests: $(INSTALLED)
	@$(BIN)/python -m compileall -q bench
	env -u PYTHONDONTWRITEBYTECODE $(BIN)/pytest --quiet --numprocesses 2 --dist worksteal

test-kernels: $(INSTALLED)
	$(BIN)/python -m tests.kernels

check: $(INSTALLED)
	$(BIN)/bench check

check-full: $(INSTALLED)
	$(BIN)/bench check --full

speed: $(INSTALLED)
	$(BIN)/python -m bench.benchmarks.speed

measured: $(INSTALLED)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m bench.benchmarks.measured

trust: $(INSTALLED)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m bench.benchmarks.trust --readme README.md

peers: $(PEERS)/.installed
	OPENBLAS_NUM_THREADS=1 $(PEERS)/bin/python -W ignore -m bench.benchmarks.peers

$(PEERS)/.installed: pyproject.toml .ci/constraints.txt .ci/constraints-peers.txt
	$(PYTHON) -m venv $(PEERS)
	$(PEERS_INSTALL) hatchling wheel
	$(PEERS_INSTALL) --no-build-isolation --editable . 'mujoco[sysid]' figaroh
	@touch $@

docs: $(INSTALLED)
	$(BIN)/properdocs build --strict --quiet -f docs/mkdocs.yml

atlas: $(INSTALLED)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python docs/atlas/draw.py

pictures: $(INSTALLED)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python docs/pictures/draw.py

format: $(INSTALLED)
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .
	$(BIN)/oxfmt --config .ci/oxfmt.json --write $(SCRIPTS)

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
	rm -rf $(VENV) $(PEERS) site .mypy_cache .ruff_cache .pytest_cache .import_linter_cache build dist
