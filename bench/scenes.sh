#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Speed and noise of real scenes beside Mitsuba 3, in alternating pairs, and Fathom's time by stage: a table in
# Markdown. Installs and builds what is missing first. See bench/scenes.py --help.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=scripts/setup.sh
source "$root/scripts/setup.sh"
install_missing "${packages_to_build[@]}" python3-venv libllvm19
(cd "$root" && build_preset release)
exec python3 "$root/bench/scenes.py" "$@"
