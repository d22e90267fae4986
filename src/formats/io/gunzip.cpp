// SPDX-License-Identifier: Apache-2.0
#include "formats/io/gunzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "fathom/error.h"

namespace fathom {

std::string gunzip(const std::string& file, std::string_view bytes)
{
    constexpr std::size_t most = std::size_t(1) << 34;
    z_stream stream{};
    if (inflateInit2(&stream, 15 + 16) != Z_OK) throw Error(file, "", "zlib ran out of memory");
    struct End {
        z_stream& stream;
        ~End() { inflateEnd(&stream); }
    } const end{stream};
    std::string text;
    std::size_t given = 0, made = 0;
    int status = Z_OK;
    while (status != Z_STREAM_END) {
        if (made == text.size()) {
            if (made >= most) throw Error(file, "", "its uncompressed size exceeds 16 GiB");
            text.resize(std::max<std::size_t>(std::size_t(1) << 16, made * 2));
        }
        const auto limited = [](std::size_t n) { return uInt(std::min<std::size_t>(n, std::size_t(1) << 30)); };
        const uInt in = limited(bytes.size() - given), out = limited(text.size() - made);
        // zlib doesn't write to its input, although the type is not const.
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + given));
        stream.avail_in = in;
        stream.next_out = reinterpret_cast<Bytef*>(text.data() + made);
        stream.avail_out = out;
        status = inflate(&stream, Z_NO_FLUSH);
        given += in - stream.avail_in;
        made += out - stream.avail_out;
        if (status != Z_OK && status != Z_STREAM_END)
            throw Error(file, "", "the compressed data is damaged or truncated");
        // A gzip file may consist of several concatenated streams.
        if (status == Z_STREAM_END && is_gzip(bytes.substr(given)) && inflateReset(&stream) == Z_OK) status = Z_OK;
    }
    text.resize(made);
    return text;
}

}  // namespace fathom
