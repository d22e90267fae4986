#pragma once

namespace fathom {

/// Leaves this process the right to compute and to read files, and takes it all others, for good, as far as the kernel
/// can do that: nothing is written, created or removed, no program started, no connection made, no other process
/// harmed.
void enter_sandbox();

}  // namespace fathom
