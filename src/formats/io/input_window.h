// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

#include "formats/io/input_file.h"

namespace fathom {

/// A sliding window over a file: usually 256 KB, which stay in the cache, and larger if a longer contiguous piece is
/// needed.
class InputWindow {
public:
    explicit InputWindow(InputFile& input) : input_(&input), buffer_(usual_size) {}

    /// Bytes of the file behind the read position.
    std::uint64_t bytes_left() const { return left_in_file() + (end_ - at_); }

    /// The following bytes without moving on: at least `least` if the file has them.
    std::string_view peek(std::size_t least)
    {
        if (end_ - at_ < least) fill(least);
        return {buffer_.data() + at_, end_ - at_};
    }
    /// Advances by `size` bytes, which the last peek() must have returned.
    void pass(std::size_t size) { at_ += size; }

    /// The next `size` bytes in one contiguous piece; null if fewer are left.
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
    std::size_t at_ = 0, end_ = 0;  ///< range of the buffer that is not read yet
    std::uint64_t got_ = 0;         ///< bytes read from the file
    bool is_at_end_ = false;
};

}  // namespace fathom
