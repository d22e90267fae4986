// SPDX-License-Identifier: Apache-2.0
#include "formats/io/read_file.h"

#include "formats/io/input_file.h"

namespace fathom {

std::string read_file(const std::filesystem::path& file)
{
    return InputFile(file).take();
}

std::string printable(std::string_view text)
{
    constexpr std::size_t limit = 80;
    std::string result;
    for (char c : text.substr(0, limit)) result += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    if (text.size() > limit) {
        // The text is not cut within a UTF-8 sequence.
        while (!result.empty() && (static_cast<unsigned char>(result.back()) & 0xc0) == 0x80) result.pop_back();
        if (!result.empty() && static_cast<unsigned char>(result.back()) >= 0xc0) result.pop_back();
        result += "...";
    }
    return result;
}

}  // namespace fathom
