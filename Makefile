# `make help` lists the targets. Everything is installed into .venv, nothing beside it.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# A file that stands for "installed as pyproject.toml and constraints.txt ask for".
INSTALLED := $(VENV)/.installed

.DEFAULT_GOAL := help

.PHONY: help
help: ## List the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## /{printf "  make %-10s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

$(INSTALLED): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[dev]"
	@touch $@

.PHONY: install
install: $(INSTALLED) ## Create .venv and install radhar and its tools into it

.PHONY: demo
demo: $(INSTALLED) ## Build configs/quickstart.yaml into datasets/quickstart and check it
	$(BIN)/radhar generate configs/quickstart.yaml -o datasets/quickstart
	$(BIN)/radhar verify datasets/quickstart

.PHONY: test
test: $(INSTALLED) ## Run the whole test suite, lint and types included
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest

.PHONY: bench
bench: $(INSTALLED) ## Measure speed and memory (about ten minutes, on a quiet machine)
	$(BIN)/python scripts/bench_generate.py

.PHONY: clean
clean: ## Remove the environment, caches and the demo data set
	rm -rf $(VENV) build datasets/quickstart .pytest_cache .mypy_cache .ruff_cache .hypothesis *.egg-info
