# make picture   sets up what it needs and renders the raymarcher to picture.png
# make test      sets up what it needs and runs what CI runs: static checks, and the tests that together
#                run every function of the source
# make test-all  the same with all tests; make test-for REV=HEAD~3 runs the tests that the change since
#                a revision can reach (the uncommitted change when not given)
# make record    records anew which functions each test runs, and chooses the tests of make test
# make bench     measures; make sweep runs thousands of random programs and draws every example
#                on every target; make clean undoes set-up
# make sweep-fields   holds every shape and operator against its claims at many more numbers
# make sweep-threads  compiles and renders in 200 processes of four threads whose interpreter switches
#                all the time (PROCESSES=1000 for more)
# make sweep-segments  follows 1e7 segments of rays and counts those on the wrong side of a surface
# make sweep-meshes  meshes every solid, the printable examples and 100 random fields, and names faults;
#                    saves the enclosure from its page at 128 cells
# make sweep-narrow  meshes 330 random solids with narrow parts at three tolerances, and names those whose
#                    topology is wrong (SOLIDS=100 SEED=7 of each kind)
# make sweep-measures measures 400 random solids with closed volumes (SOLIDS=2000 SEED=7)
# make sweep-keeping  random saves, conflicts, reloads and kills of the studio: nothing is lost
#                    (SEQUENCES=3000 for more)
# make sweep-interrupts  interrupts every command by ctrl-C at 200 moments (COMMANDS="render video",
#                    MOMENTS=20)
# make sweep-readers  damages files of every kind that others write in 500 ways each, and reads them
#                      with little memory and time (READERS=5000, SEED=7, KINDS="3MF font")
# make parity    draws every example in every place and writes docs/parity.md
# make mutate    changes the source in small ways and reports what no test notices:
#                MODULES="distal/fields distal/scene" COUNT=200 SEED=7
# make site      writes the site, with the playground, to site/; needs Node
# make versions  runs the tests on every other supported Python that is installed
#
# Needs Python 3.11 or newer (with venv) and make. Everything else goes into .venv. System packages
# are installed only for the tests, only as root and only with apt-get; else the command is printed
# and what needs them is skipped aloud.

SHELL := /bin/sh
# The tests start hundreds of processes: each would compile the library's modules again.
unexport PYTHONDONTWRITEBYTECODE
VENV := .venv
BIN := $(VENV)/bin
# The first interpreter that is new enough; `make PYTHON=... test` overrides it.
PYTHON ?= $(shell for p in python3 python3.11 python3.12 python3.13 python3.14 python; do \
	"$$p" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && echo "$$p" && break; done)
# Twice two processors: a worker waits for browsers and other processes half of its time.
WORKERS ?= 4
REV ?= HEAD
SWEEP ?= 5000
SAMPLES ?= 40
SEGMENTS ?= 1e7
PROCESSES ?= 200
MOMENTS ?= 200
TOLERANCE ?= 0.01
SEQUENCES ?= 300
MODULES ?= distal/fields distal/render distal/passes/fold* distal/scene
COUNT ?= 100
READERS ?= 500
SEED ?=
SYSTEM_PACKAGES := libegl1 libgles2 libgl1 libgl1-mesa-dri mesa-vulkan-drivers glslang-tools \
	chromium xvfb xdotool imagemagick

# A worker begins with a part of the files, and so compiles few programs that another compiles too.
UNITS = $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal -rfEs

.PHONY: picture test test-all test-for record lint style units system bench site sweep sweep-fields sweep-threads sweep-segments sweep-meshes sweep-narrow sweep-measures sweep-keeping sweep-interrupts sweep-readers parity mutate versions clean
.NOTPARALLEL:

picture: $(VENV)/.setup-run
	@$(BIN)/distal render example:raymarcher -o picture.png
	@echo "The picture is $(CURDIR)/picture.png"

# The type checker needs one processor for most of a minute: it runs beside the tests. These are not
# another make, which `make -n` would run.
CHECKED = log=$$(mktemp); $(BIN)/mypy >"$$log" 2>&1 & types=$$!; \
	$(UNITS); tests=$$?; \
	wait $$types; types=$$?; echo "$(BIN)/mypy"; cat "$$log"; rm -f "$$log"; \
	exit $$((tests | types))

# How they are chosen and why: docs/decisions/0091-the-record.md.
test: system style web/node_modules/.ready
	@export DISTAL_TESTS=chosen; $(CHECKED)

test-all: system style web/node_modules/.ready
	@$(CHECKED)

test-for: system style web/node_modules/.ready
	@$(BIN)/python -m tools.record changed $(REV) --workers $(WORKERS)

record: system $(VENV)/.setup-test web/node_modules/.ready
	@$(BIN)/python -m tools.record all --workers $(WORKERS)

lint: style
	$(BIN)/mypy

style: $(VENV)/.setup-test
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/lint-imports

# Generated files are proved fresh by tests beside the rest, so that one run names every fault.
units: $(VENV)/.setup-test web/node_modules/.ready
	$(UNITS)

bench: $(VENV)/.setup-test
	@for f in benchmarks/bench_*.py; do echo "== $$f"; $(BIN)/python "$$f" || exit 1; done

sweep: $(VENV)/.setup-test
	DISTAL_ALL_CASES=1 $(UNITS)
	DISTAL_RANDOM_PROGRAMS=$(SWEEP) $(BIN)/python -m pytest -n $(WORKERS) -rs tests/random_programs
	DISTAL_RANDOM_PROGRAMS=$(SWEEP) $(BIN)/python -m pytest -n $(WORKERS) -rs \
		tests/parts tests/smooth tests/tape tests/unit/backends
	GALLIVM_PERF= DISTAL_ALL_PICTURES=1 $(BIN)/python -m pytest -n $(WORKERS) -rs \
		tests/pictures/test_targets.py tests/export/test_whole.py
	DISTAL_ALL_PICTURES=1 $(BIN)/python -m pytest -rs tests/site/test_playground.py

sweep-fields: $(VENV)/.setup-test
	DISTAL_FIELD_SEED=$(or $(SEED),day) DISTAL_FIELD_SAMPLES=$(SAMPLES) $(BIN)/python -m pytest -n $(WORKERS) -rs tests/fields

# Processes of four nervous threads, and as many of the same scenes made alone.
sweep-threads: $(VENV)/.setup-test
	DISTAL_THREAD_PROCESSES=$(PROCESSES) $(BIN)/python -m pytest -q tests/unit/executor/test_threads.py

sweep-segments: $(VENV)/.setup-test
	DISTAL_SEGMENTS=$(SEGMENTS) $(BIN)/python -m pytest -s tests/paths/test_segment_leaks.py

# GROUPS="examples noise" runs a part; a tolerance is a share of a shape's size.
sweep-meshes: $(VENV)/.setup-test
	nice $(BIN)/python tools/sweep_meshes.py $(GROUPS) --tolerance $(TOLERANCE)
	nice $(BIN)/python tools/sweep_page.py

sweep-narrow: $(VENV)/.setup-test
	nice $(BIN)/python tools/sweep_narrow.py --count $(or $(SOLIDS),30) --seed $(or $(SEED),0)

sweep-measures: $(VENV)/.setup-test
	$(BIN)/python -m tests.mesh.closed_volumes $(or $(SOLIDS),400) $(or $(SEED),0)

sweep-keeping: $(VENV)/.setup-test
	$(BIN)/python -m tests.editor.keeping_sequences $(SEQUENCES) $(or $(SEED),0)
	$(BIN)/python -m tests.editor.keeping_in_browser $$(($(SEQUENCES) / 15)) $(or $(SEED),0)

sweep-interrupts: $(VENV)/.setup-test
	$(BIN)/python tools/sweep_interrupts.py $(COMMANDS) --count $(MOMENTS)

sweep-readers: $(VENV)/.setup-test
	nice $(BIN)/python tools/sweep_readers.py $(KINDS) --count $(READERS) --seed $(or $(SEED),1)

site: $(VENV)/.setup-test web/node_modules/.ready
	$(BIN)/python tools/build_site.py

# Every example in every place it can be drawn in, against the CPU; writes docs/parity.md.
parity: system $(VENV)/.setup-test
	$(BIN)/python tools/gen_parity.py

# Mutations are drawn by SEED (printed; another each time when not given). The first run records for
# every test which functions it runs; accepted survivors stand in tests/mutation/survivors.toml.
mutate: $(VENV)/.setup-test
	nice $(BIN)/python tools/mutate.py --count $(COUNT) $(if $(SEED),--seed $(SEED)) \
		--modules $(foreach m,$(MODULES),'$(m)')

# Python 3.11 is what `make test` uses; the others are tried where they are installed.
versions: system
	@for v in 3.12 3.13 3.14; do \
		if ! "python$$v" -c 'import venv, ensurepip' >/dev/null 2>&1; then \
			echo "== Python $$v: not installed, skipped"; continue; fi; \
		echo "== Python $$v"; \
		"python$$v" -m venv "$(VENV)-$$v" && \
		"$(VENV)-$$v/bin/python" -m pip install --quiet --disable-pip-version-check -e '.[test]' && \
		"$(VENV)-$$v/bin/python" -m pytest -n $(WORKERS) --dist worksteal -rs || exit 1; \
	done

clean:
	rm -rf $(VENV) $(VENV)-3.* build dist .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis

$(VENV)/.setup-run: $(VENV)/.setup-venv pyproject.toml
	@begin=$$(date +%s); echo "Installing distal into $(VENV) ..."; \
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e . && \
	echo "set-up: $$(($$(date +%s) - begin)) s"
	@touch $@

$(VENV)/.setup-test: $(VENV)/.setup-venv pyproject.toml
	@begin=$$(date +%s); echo "Installing distal and its test tools into $(VENV) ..."; \
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[test]' && \
	echo "set-up: $$(($$(date +%s) - begin)) s"
	@touch $@ $(VENV)/.setup-run

# Tools of the browser's side: the compiler in WebAssembly, the checker of accessibility. Never fatal.
web/node_modules/.ready: web/package-lock.json
	@if command -v npm >/dev/null 2>&1 && (cd web && npm ci --ignore-scripts --no-audit --no-fund \
		--prefer-offline >/dev/null 2>&1); then touch $@; else \
		echo "npm ci failed in web/: tests that need its packages are skipped aloud"; fi

$(VENV)/.setup-venv:
	@test -n "$(PYTHON)" || { echo "distal needs Python 3.11 or newer, and none was found." \
		"Install one, or name it: make PYTHON=/path/to/python3.11" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { echo "$(PYTHON) cannot make virtual" \
		"environments. On Debian and Ubuntu: apt-get install python3-venv" >&2; exit 1; }
	@$(BIN)/python -m pip --version >/dev/null 2>&1 || $(PYTHON) -m venv --clear $(VENV)
	@touch $@

# Drivers in software, the GLSL validator, a browser, a screen. Never fatal: the tests say what they skip and why.
system:
	@if ! command -v apt-get >/dev/null 2>&1 || ! command -v dpkg-query >/dev/null 2>&1; then \
		echo "system packages: no apt-get here; the tests use what is installed" \
			"(EGL, OpenGL, Vulkan, glslangValidator) and skip the rest aloud"; \
		exit 0; \
	fi; \
	missing=""; \
	for p in $(SYSTEM_PACKAGES); do \
		dpkg-query -W -f '$${Status}' "$$p" 2>/dev/null | grep -q 'ok installed' || missing="$$missing $$p"; \
	done; \
	test -n "$$missing" || exit 0; \
	if [ "$$(id -u)" -ne 0 ]; then \
		echo "system packages: not root; tests that need them are skipped. To run them all:"; \
		echo "    sudo apt-get install --no-install-recommends$$missing"; \
		exit 0; \
	fi; \
	echo "system packages: installing$$missing"; \
	{ apt-get update -qq && DEBIAN_FRONTEND=noninteractive \
		apt-get install -y -qq --no-install-recommends $$missing >/dev/null; } || \
		echo "system packages: apt-get failed; tests that need$$missing are skipped aloud"
