#pragma once
#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fathom/load.h"
#include "formats/pbrt/scanner.h"

namespace fathom::pbrt {

/// One parameter, `"float radius" [ 2 ]`, as it stands in the file.
struct Parameter {
    std::string type, name;
    Place place;
    std::vector<float> numbers;          ///< of all types of numbers but integers
    std::vector<std::int32_t> integers;  ///< also of booleans, 0 or 1
    std::vector<std::string> strings;    ///< also the names of textures and spectra
    mutable bool is_used = false;
};
using ParameterList = std::vector<std::shared_ptr<const Parameter>>;

/// What stands behind a directive: parameters up to the first thing that is none.
ParameterList read_parameters(Scanner& scanner);

/// What leaves a picture: the first place of each, and how often it was so.
class Teller {
public:
    explicit Teller(Warnings& warnings) : warnings_(warnings) {}
    void report(const Place& place, const std::string& message);

private:
    Warnings& warnings_;
    std::map<std::string, std::string> first_;  ///< the line that was given for a message
};

/// The colour spaces that colours may be given in.
enum class Space { srgb, dci_p3, rec2020, aces2065 };

/// A plugin's parameters, which are read by name; what nobody read is told at the end.
class Parameters {
public:
    /// kind   what it is, for messages: "Shape"
    /// preset what `Attribute` gave it: less than the plugin's own
    Parameters(std::string kind, std::string plugin, Place place, ParameterList own, ParameterList preset = {});

    const std::string& plugin() const { return plugin_; }
    const Place& place() const { return place_; }
    Space space() const { return space_; }
    void set_space(Space space) { space_ = space; }
    void set_plugin(std::string plugin) { plugin_ = std::move(plugin); }

    /// Null if there is none; counts as read.
    const Parameter* find(std::string_view name) const;
    bool has(std::string_view name) const;
    double number(std::string_view name, double otherwise) const;
    int integer(std::string_view name, int otherwise) const;
    bool boolean(std::string_view name, bool otherwise) const;
    std::string text(std::string_view name, std::string_view otherwise) const;
    std::optional<Vec3d> vector(std::string_view name) const;
    /// Empty if there is none.
    std::vector<float> numbers(std::string_view name) const;
    std::vector<std::int32_t> integers(std::string_view name) const;
    std::vector<std::string> texts(std::string_view name) const;
    std::vector<Vec3f> vectors(std::string_view name) const;
    std::vector<Vec2f> points2(std::string_view name) const;
    /// Counts as read: what it says makes no difference here.
    void ignore(std::initializer_list<std::string_view> names) const;
    /// Warns of all that nobody asked for.
    void finish(Teller& reporter) const;
    /// "Shape 'sphere'", for messages.
    std::string title() const;
    [[noreturn]] void fail(const std::string& message) const;

private:
    std::string kind_, plugin_;
    Place place_;
    ParameterList own_, preset_;
    Space space_ = Space::srgb;
};

}  // namespace fathom::pbrt
