# `make study` and `make test` are all a new user needs; each sets up .venv first.
PYTHON ?= python3.11
VENV := .venv
BIN := $(VENV)/bin
SHELL := /bin/bash

.PHONY: study test test-all lint coverage docs wheel-test clean benchmark

PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable

$(VENV)/.installed: pyproject.toml constraints.txt  # the package and what its commands need, but for training
	@command -v $(PYTHON) >/dev/null || { echo "Python 3.11 not found; set PYTHON=/path/to/python3.11"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(PIP_INSTALL) '.[search,video,view]'
	@touch $@

$(VENV)/.ready: $(VENV)/.installed  # what checks and documents it
	$(PIP_INSTALL) '.[dev,docs]'
	@touch $@

$(VENV)/.learning: $(VENV)/.installed  # torch and what goes with it, for training; other tools' fits, for baselines; and the tests of both
	$(PIP_INSTALL) '.[baselines,dev,docs,learning]'
	@touch $@

study: $(VENV)/.installed  ## Analyse the paper's biped and its ablations, sweep, and write results/study/index.html
	$(BIN)/hyperleg study --out results/study

# two processes of tests are enough for two cores: linear algebra with threads of its own gets in their way
test test-all: export OMP_NUM_THREADS = 1
test test-all: export OPENBLAS_NUM_THREADS = 1
# without its compiled modules every process that a test starts compiles the package again
test test-all study: export PYTHONDONTWRITEBYTECODE =

test: $(VENV)/.learning  ## All tests but the slow ones, style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy & types=$$!; NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict && wait $$types
	$(BIN)/python -m pytest -m "not slow" -n 2 --dist worksteal

test-all: $(VENV)/.learning  ## The slow ones too
	$(BIN)/python -m pytest -n 2 --dist worksteal

lint: $(VENV)/.ready  ## Style and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: $(VENV)/.ready  ## The documentation as a site, in site/; a warning is an error
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

coverage: $(VENV)/.learning  ## The tests, and which lines none of them runs; TESTS="tests/robot tests/sizing" runs these folders only
	$(BIN)/python -m pytest $(TESTS) -m "not slow" -n 2 --cov=hyperleg_design --cov-report=term:skip-covered --cov-report=html:results/coverage

wheel-test: $(VENV)/.ready  ## Build the wheel and try it in a clean environment
	$(BIN)/python -m pytest tests/test_wheel.py

benchmark: $(VENV)/.ready  ## Speed, as ratios in one run
	$(BIN)/python benchmarks/run.py

clean:
	rm -rf $(VENV) results .pytest_cache .mypy_cache .ruff_cache .hypothesis
