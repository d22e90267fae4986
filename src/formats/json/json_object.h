// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fathom/description.h"
#include "formats/json/json.h"

namespace fathom {

/// Notation of places in messages: `/accessors/7/count` (JSON pointer) or `accessors[7].count`.
enum class PlaceStyle { pointer, path };

/// A JSON value with the path that leads to it, so that every message can name its place. It refers to its parent and
/// to the file: both must outlive it.
class JsonValue {
public:
    JsonValue(const std::string& file, const Json& root, PlaceStyle style = PlaceStyle::pointer)
        : file_(&file), json_(&root), style_(style)
    {
    }

    JsonValue operator[](std::string_view key) const;  ///< value of a key that must exist
    JsonValue operator[](std::size_t index) const;     ///< element at an index that must be in range
    bool has(std::string_view key) const { return json_->is_object() && json_->contains(key); }
    std::optional<JsonValue> get(
        std::string_view key) const;  ///< value of a key; nothing if this is not an object or lacks the key

    const Json& json() const { return *json_; }
    std::size_t size() const { return json_->size(); }
    bool is_string() const { return json_->is_string(); }
    bool is_number() const { return json_->is_number(); }
    bool is_array() const { return json_->is_array(); }
    bool is_object() const { return json_->is_object(); }
    bool is_null() const { return json_->is_null(); }

    /// Typed access; each function throws Error if the value has another type or is not finite in the requested type.
    bool boolean() const;
    int integer() const;
    std::size_t count() const;  ///< a whole number from 0 to 2^53
    double number() const;
    float single() const;
    const std::string& string() const;
    Vec3d vec3d() const;
    Vec2f vec2f() const;
    Vec3f vec3f() const;
    Vec4f vec4f() const;
    /// One number for gray, or three for RGB.
    Color color() const;
    /// This value, if it is an array of at least `least` elements; throws Error otherwise.
    const JsonValue& array(std::size_t least = 0) const;
    const JsonValue& array_of(std::size_t elements) const;
    const JsonValue& object() const;

    /// Throws Error with the place of this value.
    [[noreturn]] void fail(const std::string& message) const;
    [[noreturn]] void fail_type(const char* expected) const;
    std::string place() const;
    const std::string& file() const { return *file_; }

private:
    const std::string* file_;
    const Json* json_;
    PlaceStyle style_;
    const JsonValue* parent_ = nullptr;
    std::string_view key_;
    std::size_t index_ = 0;
};

/// Reads the keys of one object and records which were requested; done() rejects the others.
class JsonObject {
public:
    explicit JsonObject(const JsonValue& value) : value_(value.object()) {}
    // Not copyable, because values returned by this object refer to it.
    JsonObject(const JsonObject&) = delete;
    JsonObject& operator=(const JsonObject&) = delete;

    /// The value of an optional key.
    std::optional<JsonValue> get(const char* key);
    /// The value of a key that must be there.
    JsonValue require(const char* key);

    void read(const char* key, bool& out);
    void read(const char* key, int& out);
    void read(const char* key, double& out);
    void read(const char* key, float& out);
    void read(const char* key, std::string& out);
    void read(const char* key, Vec3d& out);
    void read(const char* key, Vec2f& out);
    void read(const char* key, Color& out);

    /// Reads one of the given names; `out` is unchanged if the key is missing.
    template <class Enum>
    void read_enum(const char* key, const std::vector<std::pair<std::string, Enum>>& words, Enum& out)
    {
        if (auto v = get(key)) out = words[word_index(*v, words)].second;
    }

    /// Reads one of the given names by its index: an enumerator, a choice between false and true, or an index. `out` is
    /// unchanged if the key is missing.
    template <class Choice>
    void read_word(const char* key, std::span<const char* const> words, Choice& out)
    {
        if (auto v = get(key)) out = Choice(find_word(*v, {words.begin(), words.end()}));
    }
    /// Reads one of the given names as text; `out` is unchanged if the key is missing.
    void read_word(const char* key, std::span<const char* const> words, std::optional<std::string>& out);

    /// Throws Error for the first key that was never requested. The key "comment" is always allowed.
    ///
    /// where  appended to the message, such as "in a material of kind 'glass'"; may be empty
    void done(const std::string& where = {});

    const JsonValue& value() const { return value_; }

    /// Index of the name that `v` holds; throws Error with a suggestion if there is none.
    static std::size_t find_word(const JsonValue& v, const std::vector<std::string>& names);

private:
    template <class Pairs>
    static std::size_t word_index(const JsonValue& v, const Pairs& words)
    {
        std::vector<std::string> names;
        names.reserve(std::size(words));
        for (const auto& word : words) names.push_back(word.first);
        return find_word(v, names);
    }

    JsonValue value_;
    std::vector<std::string> known_{"comment"};
};

}  // namespace fathom
