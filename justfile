# Short names for what CONTRIBUTING.md asks for. `just` alone lists them.

default:
    @just --list

# Set up and run all tests, Rust and Python
test:
    bash tests/run

# The source distribution and a wheel for old systems, in dist/
wheels:
    crates/pybind/build-wheels

# Kill runs at a hundred random moments and resume them
kills:
    tests/run-kills

# Everything that a change must pass
ci:
    .ci/run

# Format and lint
lint:
    cargo fmt --all
    cargo clippy --release --workspace --all-targets -- -D warnings

# The documentation of the library
doc:
    RUSTDOCFLAGS="-D warnings -A rustdoc::broken_intra_doc_links" cargo doc --release --workspace --no-deps

# The site of the documents, in target/site
site:
    python3 -m venv target/docs-environment
    target/docs-environment/bin/python -m pip install --quiet -r docs/requirements.txt
    target/docs-environment/bin/mkdocs build --strict

# The notebooks with their outputs, with the package wythe
notebooks:
    python3 crates/pybind/tests/store_notebooks.py

# The pictures and the page of the gallery, with the package wythe
gallery:
    python3 docs/gallery.py

# Licences, advisories and sources of the dependencies
deny:
    cargo deny check

# The benchmarks
bench:
    cargo bench

# Run an example: just run 03_shear_wall_j7d
run name:
    cargo run --release -- run examples/{{name}}.toml
