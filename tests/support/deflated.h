// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <zlib.h>

#include <string>

namespace fathom::test {

/// Compresses bytes as zlib does.
inline std::string deflated(const std::string& bytes)
{
    uLongf size = compressBound(uLong(bytes.size()));
    std::string out(size, 0);
    compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             uLong(bytes.size()));
    out.resize(size);
    return out;
}

}  // namespace fathom::test
