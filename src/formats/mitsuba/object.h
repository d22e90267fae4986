#pragma once
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "fathom/load.h"
#include "formats/mitsuba/elements.h"

namespace fathom::mitsuba {

/// Numbers of a text, separated by blanks and commas.
std::vector<double> numbers_of(const Element& element, std::string_view text);

/// A plugin's element as its parameters, which are read by name; what nobody read is told at the end.
class Object {
public:
    Object(const Element& element, const Document& document) : element_(element), document_(document) {}

    const Element& element() const { return element_; }
    const std::string& type() const { return element_.type(); }

    /// Whether there is such a parameter, of whatever kind; references count under their name.
    bool has(std::string_view name) const { return find(name) != nullptr; }
    double number(std::string_view name, double otherwise);
    int integer(std::string_view name, int otherwise);
    bool boolean(std::string_view name, bool otherwise);
    std::string text(std::string_view name, std::string_view otherwise);
    std::optional<Vec3d> vector(std::string_view name);
    Transform transform(std::string_view name);
    /// The element of a parameter, of references what they mean; null if there is none.
    const Element* child(std::string_view name);
    /// The elements of a tag, in the order of the file, references to such among them.
    std::vector<const Element*> children(std::string_view tag);
    /// Counts as read: what it says makes no difference here.
    void ignore(std::initializer_list<std::string_view> names);
    /// Warns of all that nobody asked for.
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

/// translate, rotate, scale, matrix, lookat, one after the other.
Transform transform_of(const Element& element);

}  // namespace fathom::mitsuba
