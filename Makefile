# `make help` lists the targets. Everything is installed into .venv, nothing beside it.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Files that stand for "installed as pyproject.toml and constraints.txt ask for".
PLAIN := $(VENV)/.installed
LEARN := $(VENV)/.installed-train
DEV := $(VENV)/.installed-dev
SMOKE := build/smoke
PYTEST := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest

.DEFAULT_GOAL := help

.PHONY: help
help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## /{printf "  make %-10s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

define install
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e "$(1)"
	@touch $@
endef

$(PLAIN): pyproject.toml constraints.txt
	$(call install,.)

$(LEARN): pyproject.toml constraints.txt
	$(call install,.[train])

$(DEV): pyproject.toml constraints.txt
	$(call install,.[dev])

.PHONY: install
install: $(DEV) ## Create .venv and install radhar, its extras and its tools into it

.PHONY: demo
demo: $(PLAIN) ## Build configs/quickstart.yaml into datasets/quickstart and check it
	rm -rf datasets/quickstart # libraries that were installed since may give other bytes
	$(BIN)/radhar generate configs/quickstart.yaml -o datasets/quickstart
	$(BIN)/radhar verify datasets/quickstart

.PHONY: smoke
smoke: $(LEARN) ## Generate, train, evaluate: the smallest whole run
	rm -rf $(SMOKE)
	$(BIN)/radhar generate configs/smoke.yaml -o $(SMOKE)/data
	$(BIN)/radhar train $(SMOKE)/data -o $(SMOKE)/run --map stft --config configs/train/smoke.yaml
	$(BIN)/radhar eval $(SMOKE)/run $(SMOKE)/data --tsne --in-place-vs-moving
	$(BIN)/radhar predict $(SMOKE)/run $(SMOKE)/data/png/stft/val/walking/*.png

.PHONY: lint
lint: $(DEV) ## Style, format and types
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

.PHONY: pytest
pytest: $(DEV) ## The tests alone
	$(PYTEST) $(SELECT)

.PHONY: test
test: $(DEV) $(LEARN) ## Lint, types, tests and the smoke run, in fifteen minutes
	$(MAKE) -j 2 pytest lint smoke

.PHONY: test-all
test-all: $(DEV) $(LEARN) ## The same with every test at full size, in thirty minutes
	$(MAKE) -j 2 pytest lint smoke SELECT='-m ""'

.PHONY: site
site: $(DEV) ## Build the documentation into build/site
	$(BIN)/python -m mkdocs build --strict

.PHONY: dist
dist: $(DEV) ## Build the wheel and the archive of sources into dist
	rm -rf dist
	$(BIN)/python -m build --no-isolation

.PHONY: bench
bench: $(DEV) ## Measure speed and memory (about fifteen minutes, on a quiet machine)
	$(BIN)/python scripts/bench_generate.py
	$(BIN)/python scripts/bench_train.py
	$(BIN)/python scripts/bench_peers.py

.PHONY: clean
clean: ## Remove the environment, caches and the demo data set
	rm -rf $(VENV) build dist datasets/quickstart .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
