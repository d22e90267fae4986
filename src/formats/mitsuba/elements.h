// SPDX-License-Identifier: Apache-2.0
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

/// A position in a file, for messages.
struct Place {
    const std::string* file = nullptr;
    std::size_t line = 0, column = 0;
};

/// An XML element of the scene. Parameters (`$name`) are substituted and includes expanded; references are not
/// resolved.
struct Element {
    std::string tag;
    std::map<std::string, std::string, std::less<>> attributes;
    std::vector<std::unique_ptr<Element>> children;
    Place place;

    /// Returns the value of an attribute; empty if it is missing.
    const std::string& attribute(std::string_view name) const;
    const std::string& type() const { return attribute("type"); }
    const std::string& name() const { return attribute("name"); }
    bool has(std::string_view name) const { return attributes.find(name) != attributes.end(); }
    /// Throws Error with file, line and column.
    [[noreturn]] void fail(const std::string& message) const;
    std::string where() const;  ///< "file: line 3, column 5", for messages
};

/// The elements of a scene and of its included files.
struct Document {
    std::deque<std::string> files;  ///< names of files, to which places refer
    std::unique_ptr<Element> root;
    /// Elements by id and alias.
    std::map<std::string, const Element*, std::less<>> by_id;
    std::vector<std::filesystem::path> folders;  ///< search path for files, the scene's own folder last

    /// The element that a `ref` refers to. Throws Error.
    const Element& find(const Element& reference) const;
    /// Resolves a path that the scene refers to, in the first folder of the search path that has it.
    std::filesystem::path locate(const std::string& path, LoadContext& context) const;
};

/// Parses a scene with its includes. Throws Error.
///
/// definitions  values of parameters by name; they override the scene's defaults
Document read_document(const std::filesystem::path& file, const std::string& bytes,
                       const std::map<std::string, std::string>& definitions, LoadContext& context);

}  // namespace fathom::mitsuba
