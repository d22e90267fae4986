// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace fathom {

/// Irrevocably restricts this process to computing and reading files, as far as the kernel supports it: it can't write,
/// create or remove files, start programs, open connections or signal other processes.
void enter_sandbox();

}  // namespace fathom
