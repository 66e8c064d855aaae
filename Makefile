# `make demo` and `make test` need a Rust toolchain and install everything else themselves, see scripts/setup.

export PATH := $(PATH):$(HOME)/.cargo/bin

.DEFAULT_GOAL := help
.PHONY: help setup demo test figures bench clean

help: ## this list
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1	\2/p' $(MAKEFILE_LIST) | expand -t 18

demo: setup ## a stack of boxes on a real box that is lifted and tilted: film, table and plot in target/demo
	cargo run --release --example box_stack

test: setup ## formatting, lints, documentation and all tests
	@scripts/lints
	cargo fmt --all --check
	cargo clippy --workspace --all-targets -- --deny warnings
	RUSTDOCFLAGS="--deny warnings" cargo doc --workspace --no-deps
	cargo test --workspace

figures: setup ## measures every quality figure: a table, and target/figures.json
	cargo run --release --example figures

bench: setup ## the library beside the paper's algorithm and rebuilt meshes: docs/performance.md, and target/figures.json
	cargo run --release --package ode-visual-hull-bench

setup: ## installs what the build needs besides Rust, where it is missing
	@scripts/setup

clean: ## removes everything that was built
	cargo clean
