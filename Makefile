# make help lists the targets.
PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/pip --disable-pip-version-check --quiet

.PHONY: build demo amalgamation controller coverage prove rules fuzz mutants soak test test-clang test-sanitize test-exhaustive test-socketcan test-flood test-memory test-targets cross-compiler playground fmu site links release samples physics bench-baselines format lint clean help

build: build/build.ninja ## the firmware, its host process and .venv/bin/saddlewalk (the default)
	@$(BIN)/ninja -C build --quiet

demo: build ## one walk, end to end: live in the terminal, results in out/demo
	@$(BIN)/saddlewalk demo --out out/demo

amalgamation: ## the core as one file to add to any build, build/saddlewalk.c
	@mkdir -p build
	@$(PYTHON) tools/amalgamate.py build/saddlewalk.c

controller: cross-compiler build-cortex-m4f/build.ninja ## the image for saddlewalk demo --firmware qemu-m4
	@$(BIN)/ninja -C build-cortex-m4f --quiet saddlewalk-controller

playground: build build-wasm32/build.ninja ## the core in a page that needs nothing, build/playground.html
	@$(BIN)/ninja -C build-wasm32 --quiet playground
	@$(BIN)/python -m saddlewalk.view.playground build-wasm32/bin/playground.wasm build/playground.html

fmu: build ## the core as an FMU for Simulink, OpenModelica or Dymola, build/saddlewalk.fmu
	@$(BIN)/ninja -C build --quiet fmu

site: playground .venv/installed-site ## the documentation as a site, build/site/index.html
	@$(BIN)/python tools/site.py build/site

links: site ## every link of the site, those to other sites too, which needs the internet
	@$(BIN)/linkchecker --no-status --check-extern build/site/index.html

release: site fmu .venv/installed-test .venv/installed-release ## all files of a clean tag, in build/release, each tried
	@$(BIN)/python tools/release.py build/release
	@$(BIN)/pytest -m release --quiet --junit-xml build/reports/release.xml

cross-compiler:
	@echo | arm-none-eabi-gcc --specs=picolibc.specs -x c -E - >/dev/null 2>&1 || \
		{ echo "saddlewalk: missing: a compiler and a C library for Cortex-M; as root:" \
			"apt-get install -y gcc-arm-none-eabi picolibc-arm-none-eabi" >&2; exit 1; }

test: build/build.ninja .venv/installed-test fmu ## every test that this machine can run in minutes
	$(call run_tests,build,release,,$(MINUTES))
	@echo "Left out, with targets of their own: test-exhaustive test-flood test-memory test-socketcan test-targets release"

test-exhaustive: build/build.ninja .venv/installed-test ## the core's functions over every float
	@$(BIN)/ninja -C build --quiet tests
	@$(BIN)/ctest --preset exhaustive --output-junit reports/exhaustive.xml

test-clang: build-clang/build.ninja .venv/installed-test ## the tests of the C code, built by clang
	$(call run_tests,build-clang,clang,,$(MINUTES) and firmware)

test-sanitize: build-sanitize/build.ninja .venv/installed-test ## the same with the address and undefined sanitizers
	$(call run_tests,build-sanitize,sanitize,$(SANITIZED),$(MINUTES) and firmware)

coverage: build-coverage/build.ninja .venv/installed-test ## every branch and condition of the firmware, by the C tests
	@rm -rf build-coverage/profiles build-coverage/reports
	@$(BIN)/ninja -C build-coverage --quiet tests
	@$(BIN)/ctest --preset coverage --quiet --output-junit reports/ctest.xml
	@$(BIN)/python tests/coverage/gate.py build-coverage

prove: build ## run-time errors for any input, by Frama-C's Eva
	@$(BIN)/python tests/proof/prove.py build/firmware/wire/signals

rules: build ## MISRA C:2012 by cppcheck, and gcc's analysis of paths
	@$(BIN)/python tests/rules/check.py build

fuzz: build-fuzz/build.ninja ## random inputs under sanitizers; make fuzz HOURS=8, or SECONDS=60 in all
	@$(BIN)/ninja -C build-fuzz --quiet fuzz_targets
	@$(BIN)/python tests/fuzz/run.py build-fuzz $(if $(HOURS),$$(($(HOURS) * 3600)),$(SECONDS))

mutants: build .venv/installed-test ## whether the tests notice changed code; SAMPLE=0: every change
	@$(BIN)/ninja -C build --quiet tests
	@$(BIN)/python tests/mutants/mutate.py wire $(or $(SAMPLE),60) $(SEED) 95
	@$(BIN)/python tests/mutants/mutate.py core $(or $(SAMPLE),150) $(SEED) 95

soak: build .venv/installed-test ## hours of walks against one host process; make soak HOURS=24
	@$(BIN)/python tests/soak/soak.py $(or $(HOURS),0.5)

SECONDS := 60
SEED := $(shell date +%j)

test-socketcan: build .venv/installed-test ## the tests on the kernel's own CAN, in User Mode Linux where need be
	@tools/vcan/with-vcan build/socketcan $(BIN)/pytest -m socketcan -p no:cacheprovider \
		--junit-xml build/socketcan/pytest.xml

test-flood: build .venv/installed-test ## 5,000 frames a second for a minute
	@$(BIN)/pytest -m flood --junit-xml build/reports/flood.xml

test-memory: build .venv/installed-test ## ten minutes of the live page without growth of memory
	@$(BIN)/pytest -m memory -s --junit-xml build/reports/memory.xml

test-targets: build .venv/installed-test ## the core, the wire and their tests on controllers that QEMU emulates; docs/costs.md
	@$(BIN)/ninja -C build --quiet count_calls
	@$(BIN)/python tests/targets/run.py $(TARGETS)
	@$(BIN)/python tests/summary.py $(TARGETS:%=build-%/reports/ctest.xml)

TARGETS := cortex-m4f cortex-m7 cortex-m33 cortex-m3 rv32imafc i686 powerpc wasm32

# The Python tests, a file to each processor; those without targets of their own.
PARALLEL := --numprocesses auto --dist loadfile
MINUTES := not socketcan and not flood and not memory and not targets and not release

# $(call run_tests,BUILD_DIR,CTEST_PRESET,ENVIRONMENT_OF_PYTEST,MARKED)
define run_tests
	@rm -rf $(1)/reports
	@$(BIN)/ninja -C $(1) --quiet all tests
	-@$(BIN)/ctest --preset $(2) --output-junit reports/ctest.xml
	-@SADDLEWALK_BUILD=$(1) $(3) $(BIN)/pytest $(PARALLEL) -m "$(4)" --junit-xml $(1)/reports/pytest.xml
	@$(BIN)/python tests/summary.py $(1)/reports/ctest.xml $(1)/reports/pytest.xml
endef

# The sanitizer's runtime must come first, and C++'s before what throws in Python's extensions.
# What the interpreter keeps until it ends is not ours: tests ask the host process alone for leaks.
# Nor is what ezc3d hands numpy to free; this code has no `new` to mismatch.
SANITIZED = LD_PRELOAD="$$(gcc -print-file-name=libasan.so) libstdc++.so.6" \
	ASAN_OPTIONS=detect_leaks=0:alloc_dealloc_mismatch=0

samples: .venv/installed-samples ## recorded walks, for saddlewalk replay --sample

physics: .venv/installed-physics ## MuJoCo and a QP solver, for --plant mujoco

bench-baselines: .venv/installed-bench ## the walking QPs that saddlewalk bench compares the core with

format: .venv/installed-test ## lay out the Python and C code
	@$(BIN)/ruff check --quiet --fix .
	@$(BIN)/ruff format --quiet .
	@git ls-files '*.c' '*.h' | xargs $(BIN)/clang-format -i

lint: build/build.ninja .venv/installed-test fmu ## ruff, and clang-tidy over the firmware that this build compiles; make test checks layout and types
	@$(BIN)/ruff check --quiet .
	@$(BIN)/ruff format --quiet --check .
	@$(BIN)/ninja -C build --quiet
	@git ls-files 'firmware/*.c' | grep -v -e /mps2/ -e /port_arduino/ -e /port_wasm/ | xargs -n 4 -P $$(nproc) \
		$(BIN)/clang-tidy -p build --quiet

clean: ## remove all that was built, and the virtual environment
	rm -rf .venv build build-* out

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 15

build/build.ninja: PRESET := release
build-clang/build.ninja: PRESET := clang
build-sanitize/build.ninja: PRESET := sanitize
build-coverage/build.ninja: PRESET := coverage
build-fuzz/build.ninja: PRESET := fuzz
build-cortex-m4f/build.ninja: PRESET := cortex-m4f
build-wasm32/build.ninja: PRESET := wasm32
%/build.ninja: .venv/installed-build CMakePresets.json
	@echo "Configuring $*"
	@$(BIN)/cmake --preset $(PRESET) --fresh --log-level=WARNING
	@touch $@

.venv/bin/pip:
	@tools/bootstrap.sh $(PYTHON) .venv

# .venv/installed-EXTRA: this package, editable, and what its optional dependency EXTRA names.
.venv/installed-build: .venv/bin/pip
.venv/installed-test .venv/installed-site .venv/installed-release .venv/installed-samples .venv/installed-bench .venv/installed-physics: .venv/installed-build
.venv/installed-%: pyproject.toml requirements.lock firmware/core/include/saddlewalk/version.h
	@echo "Installing Python packages: $*"
	@PIP_CONSTRAINT=requirements.lock $(PIP) install --editable .[$*]
	@touch $@
