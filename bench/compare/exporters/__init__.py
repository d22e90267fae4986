# SPDX-License-Identifier: Apache-2.0
"""One module for each renderer: writes or builds its version of a scene of neutral.py."""
