#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Step of action.yml: installs the program into a virtual environment of its own, since many systems don't let pip change
# theirs, and puts it on the PATH of later steps.
#
# FATHOM_PACKAGE            what pip installs
# RUNNER_TEMP, GITHUB_PATH  as GitHub sets them
set -euo pipefail
folder=$RUNNER_TEMP/fathom-venv
python3 -m venv "$folder"
"$folder/bin/python" -m pip install --quiet --disable-pip-version-check "$FATHOM_PACKAGE"
mkdir -p "$RUNNER_TEMP/fathom-bin"
ln -sf "$folder/bin/fathom" "$RUNNER_TEMP/fathom-bin/fathom"
echo "$RUNNER_TEMP/fathom-bin" >> "$GITHUB_PATH"
"$folder/bin/fathom" --version
