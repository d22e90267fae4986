#pragma once
#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

#include "formats/io/input_file.h"

namespace fathom {

/// The part of a file that is being read: a few hundred kilobytes, which stay in the cache, unless more must be in one
/// piece.
class InputWindow {
public:
    explicit InputWindow(InputFile& input) : input_(&input), buffer_(usual_size) {}

    /// What is not taken yet.
    std::uint64_t bytes_left() const { return left_in_file() + (end_ - at_); }

    /// What comes next: at least so many bytes if there are.
    std::string_view peek(std::size_t least)
    {
        if (end_ - at_ < least) fill(least);
        return {buffer_.data() + at_, end_ - at_};
    }
    /// Goes on behind so many bytes of what peek gave.
    void pass(std::size_t size) { at_ += size; }

    /// The next bytes in one piece; null if there are fewer.
    const char* take(std::size_t size)
    {
        if (peek(size).size() < size) return nullptr;
        const char* const data = buffer_.data() + at_;
        at_ += size;
        return data;
    }

private:
    static constexpr std::size_t usual_size = 256 << 10;

    std::uint64_t left_in_file() const { return is_at_end_ || input_->size() < got_ ? 0 : input_->size() - got_; }
    void fill(std::size_t least)
    {
        if (is_at_end_ || end_ - at_ + left_in_file() < least) least = 0;
        std::memmove(buffer_.data(), buffer_.data() + at_, end_ - at_);
        end_ -= at_, at_ = 0;
        if (least > buffer_.size()) buffer_.resize(std::max(least, 2 * buffer_.size()));
        const std::size_t got = input_->read(buffer_.data() + end_, buffer_.size() - end_);
        is_at_end_ |= got < buffer_.size() - end_;
        end_ += got, got_ += got;
    }

    InputFile* input_;
    std::vector<char> buffer_;
    std::size_t at_ = 0, end_ = 0;  ///< what is in the buffer and not taken
    std::uint64_t got_ = 0;         ///< from the file
    bool is_at_end_ = false;
};

}  // namespace fathom
