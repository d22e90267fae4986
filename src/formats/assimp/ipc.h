#pragma once
#include <string>

#include "formats/assimp/module.h"

namespace fathom {

/// An answer as bytes that another process of the same program understands, and back.
std::string to_bytes(const AssimpAnswer& answer);
/// False if the bytes are cut short.
bool from_bytes(const std::string& bytes, AssimpAnswer& answer);

}  // namespace fathom
