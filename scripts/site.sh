#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the documentation as a site: open build/site/index.html. Warnings are errors.
#   scripts/site.sh [--output FOLDER] [--package FOLDER]
#   scripts/site.sh --external          checks the links to other sites instead, which needs the network
# --output   default: build/site
# --package  folder that contains the Python package `fathom`, whose docstrings become a page; default: build/release/python,
#            where ./test.sh builds it. "installed" stands for the one that $PYTHON has, by `pip install .`.
# $PYTHON is Python 3.11 or later with venv (default: python3). Its packages (site/requirements.txt) are installed into
# build/site-tools. If that is impossible, for example without a network, the exit code is 77.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/setup.sh
source scripts/setup.sh
output=build/site package=build/release/python builder=html python=${PYTHON:-python3}
while [ $# -gt 0 ]; do
    case $1 in
        --output) output=${2:?} && shift ;;
        --package) package=${2:?} && shift ;;
        --external) builder=linkcheck output=build/site-links ;;
        *) fail "site.sh: unknown option $1" ;;
    esac
    shift
done

# The environment is made anew for another list of packages and for another version of Python.
tools=build/site-tools
wanted=$("$python" --version && cat site/requirements.txt)
if [ "$wanted" != "$(cat "$tools/complete" 2>/dev/null)" ]; then
    rm -rf "$tools"
    if ! "$python" -m venv "$tools" || ! "$tools/bin/pip" install --quiet --disable-pip-version-check -r site/requirements.txt; then
        say "site.sh: the packages of site/requirements.txt can't be installed"
        exit 77
    fi
    echo "$wanted" >"$tools/complete"
fi

if [ "$package" = installed ]; then
    package=$("$python" -c 'import fathom, pathlib; print(pathlib.Path(fathom.__file__).parents[1])')
fi
export PYTHONDONTWRITEBYTECODE=1
PYTHONPATH=$(realpath "$package") || fail "site.sh: no Python package in $package: run ./test.sh, or see --package"
export PYTHONPATH
"$tools/bin/python" -c 'import fathom' || fail "site.sh: the Python package in $package can't be imported"

# Everything is read again each time, because warnings are only printed for pages that are read.
doctrees=$(mktemp -d)
trap 'rm -rf "$doctrees"' EXIT
rm -rf "$output"
"$tools/bin/sphinx-build" -q --fail-on-warning --keep-going --jobs auto -b "$builder" -c site -d "$doctrees" . "$output"
[ "$builder" = html ] || exit 0
cp "$output/README.html" "$output/index.html"
say "wrote $output/index.html"
