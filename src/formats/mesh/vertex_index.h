// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cstdint>
#include <vector>

namespace fathom {

/// Assigns consecutive numbers to distinct keys of three words, to merge equal vertices.
///
/// A hash table with open addressing; keys are stored in a separate array, so that growing moves only the table.
class VertexIndex {
public:
    struct Key {
        std::uint32_t a, b, c;
        friend bool operator==(const Key&, const Key&) = default;
    };

    /// The number of the key; a new key gets the next free number.
    std::uint32_t operator()(Key key)
    {
        if (2 * (keys_.size() + 1) > slots_.size()) grow();
        for (std::size_t i = hash(key) & mask();; i = (i + 1) & mask()) {
            if (slots_[i] == empty) {
                slots_[i] = std::uint32_t(keys_.size());
                keys_.push_back(key);
                return slots_[i];
            }
            if (keys_[slots_[i]] == key) return slots_[i];
        }
    }
    std::size_t size() const { return keys_.size(); }

private:
    static constexpr std::uint32_t empty = ~0u;
    std::size_t mask() const { return slots_.size() - 1; }
    static std::size_t hash(Key k)
    {
        std::uint64_t h = k.a * 0x9e3779b97f4a7c15u;
        h = (std::rotl(h, 29) ^ k.b) * 0xbf58476d1ce4e5b9u;
        h = (std::rotl(h, 31) ^ k.c) * 0x94d049bb133111ebu;
        return std::size_t(h ^ h >> 32);
    }
    void grow()
    {
        slots_.assign(slots_.empty() ? 8 : 2 * slots_.size(), empty);
        for (std::size_t n = 0; n < keys_.size(); ++n) {
            std::size_t i = hash(keys_[n]) & mask();
            while (slots_[i] != empty) i = (i + 1) & mask();
            slots_[i] = std::uint32_t(n);
        }
    }
    std::vector<Key> keys_;
    std::vector<std::uint32_t> slots_;
};

}  // namespace fathom
