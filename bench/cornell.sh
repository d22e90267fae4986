#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Speed of the Cornell box beside Mitsuba 3, in alternating pairs; prints JSON. See bench/cornell.py --help.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
exec python3 "$root/bench/cornell.py" "$@"
