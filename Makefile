# `make demo` and `make test` need a Rust toolchain and install everything else themselves, see scripts/setup.

export PATH := $(PATH):$(HOME)/.cargo/bin

PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
INSTALL ?= install

VERSION := $(shell sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
MAJOR := $(firstword $(subst ., ,$(VERSION)))
RELEASE := $(or $(CARGO_TARGET_DIR),target)/release
LIBRARY := libode_visual_hull
INSTALLED := $(INCLUDEDIR)/ode_visual_hull.h $(LIBDIR)/pkgconfig/ode_visual_hull.pc \
	$(addprefix $(LIBDIR)/$(LIBRARY),.a .so .so.$(MAJOR) .so.$(VERSION))

.DEFAULT_GOAL := help
.PHONY: help setup lib install uninstall demo demo-real demo-live showcase test test-viewer figures bench clean

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1	\2/p' $(MAKEFILE_LIST) | expand -t 18

VHULL_VIEW := cargo run --quiet --release --package ode-visual-hull-viewer --no-default-features --bin vhull-view --

demo: setup ## a stack of boxes on a real box that is lifted and tilted: two films, table and plot in target/demo
	@rm -rf target/demo/recording
	cargo run --release --example box_stack -- --record target/demo/recording
	@cargo build --release --package ode-visual-hull-viewer --no-default-features
	$(VHULL_VIEW) film target/demo/recording --states target/demo/states.csv --tour examples/box_stack/tour.toml \
		--size 480x360 --out target/demo/from_anywhere.gif

demo-real: ## a real person knocks over such a stack: fetches a recording, film, table and plot in target/demo-real
	@scripts/setup ffmpeg python3-pip
	cargo build --release --package vhull
	cargo build --release --package ode-visual-hull-viewer --no-default-features
	@scripts/demo-real $(or $(CARGO_TARGET_DIR),target)

LIVE := cargo run --quiet --release --package ode-visual-hull-viewer --no-default-features --features window \
	--bin vhull-view -- live $(or $(RECORDING),--synthetic) --bodies rain --count 20 --side 0.12

demo-live: setup ## a synthetic person in a rain of boxes, live in a window; RECORDING=DIR plays one; a film without a display
	@cargo build --release --package ode-visual-hull-viewer --no-default-features --features window
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then $(LIVE); else \
		echo "no display: what the window would show goes to target/demo-live/live.mp4"; \
		$(LIVE) --headless --seconds 15 --film target/demo-live/live.mp4; fi

SHOWCASE := domino_spiral pyramid newtons_cradle balance_bird grab grab_with_button

showcase: setup ## scenes that other engines show too, and hands that grab, all with a real subject: films in target/<scene>
	cargo build --release $(addprefix --example ,$(SHOWCASE))
	@set -e; for scene in $(SHOWCASE); do cargo run --quiet --release --example $$scene; done

test: setup ## formatting, lints, documentation and all tests
	@scripts/lints
	cargo fmt --all --check
	cargo clippy --all-targets -- --deny warnings
	tests/without_ode.sh
	RUSTDOCFLAGS="--deny warnings" cargo doc --no-deps
	cargo test
	tests/install.sh
	tests/thread_sanitizer.sh
	tests/ode_demos.sh

# The viewer's libraries take as long to build as everything else, so that they have a target of their own. Mesa's rasteriser
# stands in where there is no GPU, Xvfb where there is no screen.
VIEWER := --package ode-visual-hull-viewer

test-viewer: ## lints, documentation and tests of the viewer, on a GPU or on Mesa's rasteriser without one
	@scripts/setup libegl1 libgl1-mesa-dri libx11-xcb1 libxcursor1 libxi6 libxkbcommon-x11-0 xvfb xdotool
	cargo clippy $(VIEWER) --all-targets -- --deny warnings
	cargo clippy $(VIEWER) --no-default-features --all-targets -- --deny warnings
	RUSTDOCFLAGS="--deny warnings" cargo doc $(VIEWER) --no-deps
	cargo test $(VIEWER)

figures: setup ## measures every quality figure: tables, and target/figures.json
	cargo run --release --example figures
	cargo run --release --package ode-visual-hull-bench -- --only segmentation --only motion
	@scripts/setup libegl1 libgl1-mesa-dri
	cargo run --release $(VIEWER) --example view_figures

bench: setup ## the library beside the paper's algorithm and rebuilt meshes: docs/performance.md, and target/figures.json
	cargo run --release --package ode-visual-hull-bench

lib: $(RELEASE)/$(LIBRARY).so ## the C library, shared and static, in target/release

# As a file with its sources, so that `make lib` builds it and `sudo make install` only copies.
$(RELEASE)/$(LIBRARY).so: Cargo.toml Cargo.lock $(wildcard build.rs ode-sys/*.rs) $(shell find src ode-sys/src ode-sys/build -name '*.rs')
	cargo build --release --lib
	@touch $@ $(RELEASE)/$(LIBRARY).a

install: lib ## header, libraries and pkg-config file, under PREFIX=/usr/local, or in the tree DESTDIR for packagers
	$(INSTALL) -d $(DESTDIR)$(INCLUDEDIR) $(DESTDIR)$(LIBDIR)/pkgconfig
	$(INSTALL) -m 644 include/ode_visual_hull.h $(DESTDIR)$(INCLUDEDIR)
	$(INSTALL) -m 755 $(RELEASE)/$(LIBRARY).so $(DESTDIR)$(LIBDIR)/$(LIBRARY).so.$(VERSION)
	ln -sf $(LIBRARY).so.$(VERSION) $(DESTDIR)$(LIBDIR)/$(LIBRARY).so.$(MAJOR)
	ln -sf $(LIBRARY).so.$(MAJOR) $(DESTDIR)$(LIBDIR)/$(LIBRARY).so
	$(INSTALL) -m 644 $(RELEASE)/$(LIBRARY).a $(DESTDIR)$(LIBDIR)
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIBDIR@|$(LIBDIR)|' -e 's|@INCLUDEDIR@|$(INCLUDEDIR)|' \
		-e 's|@VERSION@|$(VERSION)|' ode_visual_hull.pc.in > $(DESTDIR)$(LIBDIR)/pkgconfig/ode_visual_hull.pc
	@[ -n "$(DESTDIR)" ] || ldconfig 2>/dev/null || true

uninstall: ## removes what install put there; same PREFIX and DESTDIR
	rm -f $(addprefix $(DESTDIR),$(INSTALLED))
	@[ -n "$(DESTDIR)" ] || ldconfig 2>/dev/null || true

setup: ## installs what the build needs besides Rust, where it is missing
	@scripts/setup

clean: ## removes everything that was built
	cargo clean
