// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/ordered_map.hpp>

namespace fathom {

/// nlohmann::ordered_map with a hash table for large objects: the original searches keys linearly, which makes reading
/// an object quadratic in its number of keys.
template <class Key, class T, class IgnoredLess = std::less<Key>,
          class Allocator = std::allocator<std::pair<const Key, T>>>
class IndexedMap : public nlohmann::ordered_map<Key, T, IgnoredLess, Allocator> {
    using Base = nlohmann::ordered_map<Key, T, IgnoredLess, Allocator>;

public:
    using Base::Base;
    using typename Base::const_iterator;
    using typename Base::iterator;
    using typename Base::size_type;

    template <class KeyType>
    std::pair<iterator, bool> emplace(KeyType&& key, T&& value)
    {
        if (const iterator found = find(key); found != this->end()) return {found, false};
        // The table is updated on each insertion. After any other change the sizes disagree, and the table is rebuilt.
        const bool is_indexed = indexed_ == this->size();
        Base::Container::emplace_back(std::forward<KeyType>(key), std::move(value));
        if (this->size() > fewest)
            is_indexed && 2 * this->size() <= slots_.size() ? add(this->size() - 1) : index_all();
        return {std::prev(this->end()), true};
    }
    template <class KeyType>
    T& operator[](KeyType&& key)
    {
        return emplace(std::forward<KeyType>(key), T{}).first->second;
    }
    template <class KeyType>
    const T& operator[](KeyType&& key) const
    {
        return find(key)->second;
    }
    template <class KeyType>
    iterator find(const KeyType& key)
    {
        return this->begin() + (std::as_const(*this).find(key) - std::as_const(*this).begin());
    }
    template <class KeyType>
    const_iterator find(const KeyType& key) const
    {
        if (this->size() <= fewest || indexed_ != this->size())
            return std::find_if(this->begin(), this->end(), [&](const auto& member) { return member.first == key; });
        for (std::size_t i = first_slot(key);; i = (i + 1) & (slots_.size() - 1)) {
            if (slots_[i] == free_slot) return this->end();
            const const_iterator at = this->begin() + slots_[i];
            if (at->first == key) return at;
        }
    }
    template <class KeyType>
    size_type count(const KeyType& key) const
    {
        return find(key) != this->end();
    }

private:
    static constexpr size_type fewest = 16;
    static constexpr std::uint32_t free_slot = ~0u;

    std::size_t first_slot(std::string_view key) const
    {
        return std::hash<std::string_view>()(key) & (slots_.size() - 1);
    }
    void add(size_type position)
    {
        std::size_t i = first_slot((this->begin() + std::ptrdiff_t(position))->first);
        while (slots_[i] != free_slot) i = (i + 1) & (slots_.size() - 1);
        slots_[i] = std::uint32_t(position);
        indexed_ = this->size();
    }
    void index_all()
    {
        std::size_t slots = 4 * fewest;
        while (slots < 4 * this->size()) slots *= 2;
        slots_.assign(slots, free_slot);
        for (size_type i = 0; i < this->size(); ++i) add(i);
    }

    std::vector<std::uint32_t> slots_;  ///< positions by the hash of their key (open addressing); the size is a power
                                        ///< of two
    size_type indexed_ = 0;             ///< number of keys when the table was last up to date
};

}  // namespace fathom
