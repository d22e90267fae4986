// SPDX-License-Identifier: Apache-2.0
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

/// One parameter of a directive as written, such as `"float radius" [ 2 ]`.
struct Parameter {
    std::string type, name;
    Place place;
    std::vector<float> numbers;          ///< values of all numeric types except integers
    std::vector<std::int32_t> integers;  ///< values of integers, and of booleans as 0 or 1
    std::vector<std::string> strings;    ///< strings, and names of textures and spectra
    mutable bool is_used = false;
};
using ParameterList = std::vector<std::shared_ptr<const Parameter>>;

/// Reads the parameters that follow a directive, up to the first token of another kind.
ParameterList read_parameters(Scanner& scanner);

/// Collects warnings about unsupported features: the first place of each message, and how often it occurred.
class WarningReporter {
public:
    explicit WarningReporter(Warnings& warnings) : warnings_(warnings) {}
    void report(const Place& place, const std::string& message);

private:
    Warnings& warnings_;
    std::map<std::string, std::string> first_;  ///< the full text reported for each message
};

/// The color spaces of RGB parameters.
enum class Space { srgb, dci_p3, rec2020, aces2065 };

/// The parameters of a plugin, read by name. finish() reports the parameters that were never read.
class Parameters {
public:
    /// kind    type of the plugin, for messages: "Shape"
    /// preset  parameters of the `Attribute` directive, which the plugin's own override
    Parameters(std::string kind, std::string plugin, Place place, ParameterList own, ParameterList preset = {});

    const std::string& plugin() const { return plugin_; }
    const Place& place() const { return place_; }
    Space space() const { return space_; }
    void set_space(Space space) { space_ = space; }
    void set_plugin(std::string plugin) { plugin_ = std::move(plugin); }

    /// The parameter, which is marked as read; null if it is missing.
    const Parameter* find(std::string_view name) const;
    bool has(std::string_view name) const;
    /// Value of a parameter, or the default if it is missing; marks it as read. Throws Error if it has another type.
    double number(std::string_view name, double otherwise) const;
    int integer(std::string_view name, int otherwise) const;
    bool boolean(std::string_view name, bool otherwise) const;
    std::string text(std::string_view name, std::string_view otherwise) const;
    /// A point or vector; nothing if the parameter is missing.
    std::optional<Vec3d> vector(std::string_view name) const;
    /// An array of numbers; empty if the parameter is missing.
    std::vector<float> numbers(std::string_view name) const;
    std::vector<std::int32_t> integers(std::string_view name) const;
    std::vector<std::string> texts(std::string_view name) const;
    std::vector<Vec3f> vectors(std::string_view name) const;
    std::vector<Vec2f> points2(std::string_view name) const;
    /// Marks parameters that have no effect in Fathom as read.
    void ignore(std::initializer_list<std::string_view> names) const;
    /// Warns of all parameters that were never read.
    void finish(WarningReporter& reporter) const;
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
