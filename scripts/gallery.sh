#!/usr/bin/env bash
# Renders every model of a folder, with no options but a size, to thumbnails on one HTML page.
#   scripts/gallery.sh FOLDER [-o OUT] [--spp N] [--size WxH]    OUT: a folder, made if it isn't there (default gallery)
# FATHOM names the program (default: fathom, or that of build/release). The page needs nothing but its folder.
set -euo pipefail
exec python3 "$(dirname "${BASH_SOURCE[0]}")/gallery.py" "$@"
