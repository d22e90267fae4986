#pragma once
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "formats/common/load_context.h"

namespace fathom::mitsuba {

/// Where something stands, for messages.
struct Place {
    const std::string* file = nullptr;
    std::size_t line = 0, column = 0;
};

/// An element of the scene, with parameters put in: `$name` is its value, what was included is there, references are
/// still references.
struct Element {
    std::string tag;
    std::map<std::string, std::string, std::less<>> attributes;
    std::vector<std::unique_ptr<Element>> children;
    Place place;

    /// Empty if there is none.
    const std::string& attribute(std::string_view name) const;
    const std::string& type() const { return attribute("type"); }
    const std::string& name() const { return attribute("name"); }
    bool has(std::string_view name) const { return attributes.find(name) != attributes.end(); }
    /// Throws Error with file, line and column.
    [[noreturn]] void fail(const std::string& message) const;
    std::string where() const;  ///< "file: line 3, column 5", as fail says it
};

/// A scene's elements, those of included files among them.
struct Document {
    std::deque<std::string> files;  ///< that places name
    std::unique_ptr<Element> root;
    /// By id, aliases too.
    std::map<std::string, const Element*, std::less<>> by_id;
    std::vector<std::filesystem::path> folders;  ///< in which paths are looked for, the scene's own last

    /// What a `ref` means. Throws Error.
    const Element& find(const Element& reference) const;
    /// Where a file is that a scene names: in the first folder that has it.
    std::filesystem::path locate(const std::string& path, LoadContext& context) const;
};

/// definitions  values of parameters, by name; they go before the scene's own defaults
Document read_document(const std::filesystem::path& file, const std::string& bytes,
                       const std::map<std::string, std::string>& definitions, LoadContext& context);

}  // namespace fathom::mitsuba
