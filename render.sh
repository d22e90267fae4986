#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Renders a scene; installs and builds first what that needs.
#   ./render.sh                              the Cornell box, to cornell-box.png
#   ./render.sh SCENE [OPTION]...            as `fathom render SCENE [OPTION]...`
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=scripts/setup.sh
source "$here/scripts/setup.sh"

install_missing "${packages_to_build[@]}"
(cd "$here" && build_preset release program)
if [ $# -eq 0 ]; then
    set -- "$here/scenes/cornell-box.json" --spp 64 -o cornell-box.png
fi
exec "$here/build/release/bin/fathom" render "$@"
