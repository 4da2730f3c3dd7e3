# make help lists the targets.
PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/pip --disable-pip-version-check --quiet

.PHONY: build demo test test-clang test-sanitize samples format clean help

build: build/build.ninja ## the firmware, its host process and .venv/bin/saddlewalk (the default)
	@$(BIN)/ninja -C build --quiet

demo: build ## one walk, end to end: live in the terminal, results in out/demo
	@$(BIN)/saddlewalk demo --out out/demo

test: build .venv/installed-test ## every test that this machine can run
	@rm -rf build/reports
	@$(BIN)/ninja -C build --quiet tests
	-@$(BIN)/ctest --preset release --output-junit reports/ctest.xml
	-@$(BIN)/pytest --junit-xml build/reports/pytest.xml
	@$(BIN)/python tests/summary.py build/reports/ctest.xml build/reports/pytest.xml

test-clang: build-clang/build.ninja .venv/installed-test ## the C tests, built by clang
	@rm -rf build-clang/reports
	@$(BIN)/ninja -C build-clang --quiet all tests
	-@$(BIN)/ctest --preset clang --output-junit reports/ctest.xml
	@$(BIN)/python tests/summary.py build-clang/reports/ctest.xml

test-sanitize: build-sanitize/build.ninja .venv/installed-test ## all but the walks over every float
	@rm -rf build-sanitize/reports
	@$(BIN)/ninja -C build-sanitize --quiet all tests
	-@$(BIN)/ctest --preset sanitize --output-junit reports/ctest.xml
	-@SADDLEWALK_BUILD=build-sanitize LD_PRELOAD="$$(cc -print-file-name=libasan.so)" \
		LSAN_OPTIONS=suppressions=$(CURDIR)/tests/lsan.supp:print_suppressions=0 \
		$(BIN)/pytest --junit-xml build-sanitize/reports/pytest.xml
	@$(BIN)/python tests/summary.py build-sanitize/reports/ctest.xml build-sanitize/reports/pytest.xml

samples: .venv/installed-samples ## recorded walks, for saddlewalk replay --sample

format: .venv/installed-test ## lay out the Python code
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

clean: ## remove all that was built, and the virtual environment
	rm -rf .venv build build-clang build-sanitize out

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 16

build/build.ninja: PRESET := release
build-clang/build.ninja: PRESET := clang
build-sanitize/build.ninja: PRESET := sanitize
%/build.ninja: .venv/installed-build CMakePresets.json
	@echo "Configuring $*"
	@$(BIN)/cmake --preset $(PRESET) --fresh --log-level=WARNING
	@touch $@

.venv/bin/pip:
	@tools/bootstrap.sh $(PYTHON) .venv

# .venv/installed-EXTRA: this package, editable, and what its optional dependency EXTRA names.
.venv/installed-build: .venv/bin/pip
.venv/installed-test .venv/installed-samples: .venv/installed-build
.venv/installed-%: pyproject.toml requirements.lock firmware/core/include/saddlewalk/version.h
	@echo "Installing Python packages: $*"
	@PIP_CONSTRAINT=requirements.lock $(PIP) install --editable .[$*]
	@touch $@
