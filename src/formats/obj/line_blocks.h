// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "formats/io/input_file.h"

namespace fathom {

/// Reads a text file in blocks of whole lines; lines continued by a backslash stay together. A lone CR, as in old
/// Macintosh files, becomes LF.
class LineBlocks {
public:
    static constexpr std::size_t usual_size = 512 << 10;

    /// size  minimum size of a block, except the last
    explicit LineBlocks(InputFile& input, std::size_t size = usual_size) : input_(input), size_(size) {}

    /// Reads the next block, which ends with a line end even at the end of the file. False after the last block.
    bool next(std::string& text)
    {
        text = rest_;
        rest_.clear();
        for (std::size_t more = size_; !is_at_end_; more = text.size()) {
            const std::size_t had = text.size();
            text.resize(had + more);
            const std::size_t got = input_.read(text.data() + had, more);
            text.resize(had + got);
            is_at_end_ = got < more;
            end_lines_at_lone_cr(text, had > 0 ? had - 1 : 0);
            if (is_at_end_) break;
            if (const std::size_t end = last_line_end(text)) {
                rest_.assign(text, end);
                text.resize(end);
                return true;
            }
        }
        if (text.empty()) return false;
        if (text.back() != '\n') text += '\n';
        return true;
    }

private:
    /// A CR at the end of the buffer is left until the following byte is known.
    void end_lines_at_lone_cr(std::string& text, std::size_t from) const
    {
        for (std::size_t at = text.find('\r', from); at != std::string::npos; at = text.find('\r', at + 1)) {
            const bool is_last = at + 1 == text.size();
            if (is_last ? is_at_end_ : text[at + 1] != '\n') text[at] = '\n';
        }
    }
    /// Offset behind the last complete line; 0 if there is none.
    static std::size_t last_line_end(std::string_view text)
    {
        for (std::size_t end = text.size(); end > 0;) {
            end = text.find_last_of('\n', end - 1);
            if (end == std::string_view::npos) return 0;
            std::string_view line = text.substr(0, end);
            if (line.ends_with('\r')) line.remove_suffix(1);
            if (!line.ends_with('\\')) return end + 1;
        }
        return 0;
    }

    InputFile& input_;
    std::size_t size_;
    std::string rest_;  ///< beginning of the next block
    bool is_at_end_ = false;
};

}  // namespace fathom
