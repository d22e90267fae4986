// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Exports a class or function from libfathom. The library is compiled with hidden visibility, so that only symbols
/// with this attribute can be linked against.
#define FATHOM_API __attribute__((visibility("default")))
