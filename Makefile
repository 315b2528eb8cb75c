# Each target sets up what it needs first: system packages, .venv, the install. The second time that is instant.

# One thread per library call: sizeviz has its own threads, and pytest its own processes.
export OPENBLAS_NUM_THREADS ?= 1
export OMP_NUM_THREADS ?= 1
export MKL_NUM_THREADS ?= 1

BIN := .venv/bin
WORKERS ?= 2

.PHONY: help demo test test-qt6 lint format bench docs screenshots setup clean

help:
	@echo "make demo         the MRI example by both methods: a table, and demo/compare.png"
	@echo "make test         the whole test suite"
	@echo "make test-qt6     the window's tests with PyQt6 in place of PyQt5, in .venv-qt6"
	@echo "make lint         ruff, mypy, import-linter, typos"
	@echo "make bench        every benchmark, one after the other"
	@echo "make docs         the site: tutorials, how-to, algorithms, Python; into docs/_build/html"
	@echo "make screenshots  the pictures of README and docs, made anew"

demo:
	@.ci/setup picture
	@$(BIN)/sizeviz compare mri --out demo
	@echo "The picture is demo/compare.png"

test:
	@.ci/setup full
	@$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile

test-qt6:
	@.ci/setup qt6
	@QT_API=pyqt6 .venv-qt6/bin/python -m pytest tests/app -o qt_api=pyqt6

lint:
	@.ci/setup full
	@$(BIN)/ruff check --output-format concise .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/lint-imports
	@$(BIN)/typos

format:
	@.ci/setup full
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

bench:
	@.ci/setup full
	@set -e; for file in benchmarks/[a-z]*.py; do echo "== $$file"; $(BIN)/python $$file; done

docs:
	@.ci/setup full
	@$(BIN)/python -m sphinx -W --keep-going -q -b html docs docs/_build/html
	@echo "The site is docs/_build/html/index.html"

screenshots:
	@.ci/setup full
	@set -e; for file in screenshots/make*.py; do $(BIN)/python $$file; done

setup:
	@.ci/setup full

clean:
	rm -rf .venv .venv-qt6 build dist demo docs/_build docs/auto_tutorials .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find sizeviz tests benchmarks -name __pycache__ -prune -exec rm -rf {} +
