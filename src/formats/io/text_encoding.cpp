// SPDX-License-Identifier: Apache-2.0
#include "formats/io/text_encoding.h"

#include "fathom/error.h"

namespace fathom {

bool is_wide_text(std::string_view text)
{
    if (text.size() < 2) return false;
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) return true;
    // Big-endian UTF-32 begins with two zero bytes.
    return (text[0] == '\0') != (text[1] == '\0') || text.starts_with(std::string_view("\0\0\xfe\xff", 4));
}

std::string_view utf8_text(const std::string& file, std::string_view text)
{
    if (is_wide_text(text)) throw Error(file, "", "is text in UTF-16 or UTF-32: save it as UTF-8");
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    return text;
}

}  // namespace fathom
