// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "fathom/load.h"
#include "formats/mitsuba/elements.h"

namespace fathom::mitsuba {

/// The numbers in a text, separated by whitespace and commas.
std::vector<double> numbers_of(const Element& element, std::string_view text);

/// The parameters of a plugin's element, read by name. finish() reports the parameters that were never read.
class Object {
public:
    Object(const Element& element, const Document& document) : element_(element), document_(document) {}

    const Element& element() const { return element_; }
    const std::string& type() const { return element_.type(); }

    /// Whether the parameter exists, of any type; references count under their name.
    bool has(std::string_view name) const { return find(name) != nullptr; }
    /// Value of a parameter, or the default if it is missing; marks it as read. Throws Error if it has another type.
    double number(std::string_view name, double otherwise);
    int integer(std::string_view name, int otherwise);
    bool boolean(std::string_view name, bool otherwise);
    std::string text(std::string_view name, std::string_view otherwise);
    /// A point or vector; nothing if the parameter is missing.
    std::optional<Vec3d> vector(std::string_view name);
    /// A transform; the identity if the parameter is missing.
    Transform transform(std::string_view name);
    /// The element of a parameter, with references resolved; null if it is missing.
    const Element* child(std::string_view name);
    /// The child elements of a tag in the order of the file, with references resolved.
    std::vector<const Element*> children(std::string_view tag);
    /// Marks parameters that have no effect in Fathom as read.
    void ignore(std::initializer_list<std::string_view> names);
    /// Warns of all parameters that were never read.
    void finish(Warnings& warnings) const;
    /// "bsdf 'plastic'", for messages.
    std::string title() const;

private:
    const Element* find(std::string_view name) const;
    const Element* use(std::string_view name);

    const Element& element_;
    const Document& document_;
    std::set<const Element*> used_;
};

/// The product of the element's translate, rotate, scale, matrix and lookat, in order.
Transform transform_of(const Element& element);

}  // namespace fathom::mitsuba
