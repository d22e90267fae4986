#pragma once
/// Marks what the library offers; everything else stays inside it.
#define FATHOM_API __attribute__((visibility("default")))
