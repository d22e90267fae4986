#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Renders every model in a folder to thumbnails on an HTML page, with default options except for the size.
#   scripts/gallery.sh FOLDER [-o OUT] [--spp N] [--size WxH]    OUT: output folder, created if missing (default
#   gallery)
# FATHOM names the program (default: fathom, or that of build/release). The page depends on no file outside its folder.
set -euo pipefail
exec python3 "$(dirname "${BASH_SOURCE[0]}")/gallery.py" "$@"
