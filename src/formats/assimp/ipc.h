// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "formats/assimp/module.h"

namespace fathom {

/// Serializes an answer for another process of the same program.
std::string to_bytes(const AssimpAnswer& answer);
/// Deserializes an answer. False if the bytes are truncated.
bool from_bytes(const std::string& bytes, AssimpAnswer& answer);

}  // namespace fathom
