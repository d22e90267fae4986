namespace fathom { int kernel_stub; }
