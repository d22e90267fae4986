// SPDX-License-Identifier: Apache-2.0
#include "formats/mitsuba/elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <pugixml.hpp>
#include <set>

#include "fathom/error.h"
#include "formats/common/suggest.h"
#include "formats/io/read_file.h"
#include "formats/io/text_encoding.h"
#include "formats/mitsuba/legacy_names.h"

namespace fathom::mitsuba {

namespace {

/// Maximum nesting of elements: more than real scenes have, and few enough for the stack that recursion uses.
constexpr int deepest_element = 100, deepest_include = 15;
/// Repeated includes can turn small files into huge scenes.
constexpr std::size_t max_elements = 50'000'000;

const std::string none;

/// Returns the path of a file in the first folder that has it.
std::optional<std::filesystem::path> first_existing(const std::vector<std::filesystem::path>& folders,
                                                    const std::string& name, LoadContext& context)
{
    for (const std::filesystem::path& folder : folders) {
        std::filesystem::path found = context.locate(folder / name);
        std::error_code error;
        if (std::filesystem::exists(found, error)) return found;
    }
    return std::nullopt;
}

class DocumentReader {
public:
    DocumentReader(const std::map<std::string, std::string>& definitions, LoadContext& context)
        : parameters_(definitions), given_(definitions), context_(context)
    {
    }

    Document read(const std::filesystem::path& file, const std::string& bytes)
    {
        document_.folders.push_back(file.parent_path());
        document_.root = std::make_unique<Element>();
        read_file_into(*document_.root, file, bytes, 0);
        for (const auto& [name, value] : given_)
            if (!used_.contains(name))
                throw Error(file.string(), "-D " + name,
                            fmt::format("the scene has no parameter '{}'{}", printable(name),
                                        suggestion(name, {known_.begin(), known_.end()})));
        register_ids(*document_.root);
        for (const auto& [alias, element] : aliases_) {
            const auto found = document_.by_id.find(element->attribute("id"));
            if (found == document_.by_id.end())
                element->fail(fmt::format("no element has the id '{}'", printable(element->attribute("id"))));
            document_.by_id.emplace(alias, found->second);
        }
        return std::move(document_);
    }

private:
    struct Source {
        const std::string* file;
        std::vector<std::size_t> lines;  ///< offset of each line's beginning
        bool has_legacy_names = false;
        std::string name;  ///< name that <include> gives to the object in the file
        /// Search path for includes: the file's own folder, then those of the files that include it.
        std::vector<std::filesystem::path> folders;

        Place place(std::ptrdiff_t offset) const
        {
            const auto at = std::size_t(std::max<std::ptrdiff_t>(offset, 0));
            const auto after = std::upper_bound(lines.begin(), lines.end(), at);
            return {file, std::size_t(after - lines.begin()), at - *(after - 1) + 1};
        }
    };

    void read_file_into(Element& parent, const std::filesystem::path& file, const std::string& bytes, int depth,
                        const Source* includer = nullptr, const std::string& name = "")
    {
        Source source{&document_.files.emplace_back(file.string()), {0}, false, "", {file.parent_path()}};
        if (includer) source.folders.insert(source.folders.end(), includer->folders.begin(), includer->folders.end());
        const std::string_view text = utf8_text(*source.file, bytes);
        for (std::size_t i = 0; i < text.size(); ++i)
            if (text[i] == '\n') source.lines.push_back(i + 1);
        pugi::xml_document xml;
        const pugi::xml_parse_result result = xml.load_buffer(text.data(), text.size());
        if (!result) {
            const Place place = source.place(result.offset);
            throw Error(*source.file, fmt::format("line {}, column {}", place.line, place.column),
                        fmt::format("not XML: {}", result.description()));
        }
        const pugi::xml_node root = xml.document_element();
        const bool is_scene = std::string_view(root.name()) == "scene";
        if (!(is_scene || (depth > 0 && is_object(root.name()))) || !root.attribute("version"))
            throw Error(*source.file, fmt::format("line {}", source.place(root.offset_debug()).line),
                        fmt::format("a Mitsuba scene must begin with <scene version=\"...\">, found <{}>",
                                    printable(root.name())));
        source.has_legacy_names = root.attribute("version").as_int() < 2;
        if (!is_scene) {
            source.name = name;
            return read_node(parent, root, source, 1, depth);
        }
        if (depth == 0) parent.tag = "scene", parent.place = source.place(root.offset_debug());
        for (const pugi::xml_node node : root.children()) read_node(parent, node, source, 1, depth);
    }

    void read_node(Element& parent, const pugi::xml_node& node, const Source& source, int depth, int includes)
    {
        if (node.type() != pugi::node_element) {
            if (node.type() == pugi::node_pcdata) {
                Element text;
                text.place = source.place(node.offset_debug());
                text.fail(fmt::format("unexpected text outside of elements: '{}'", printable(node.value())));
            }
            return;
        }
        if (++elements_ > max_elements)
            throw Error(*source.file, "", fmt::format("more than {} elements", max_elements));
        auto element = std::make_unique<Element>();
        element->tag = node.name();
        element->place = source.place(node.offset_debug());
        if (depth > deepest_element)
            element->fail(fmt::format("elements are nested more than {} deep", deepest_element));
        for (const pugi::xml_attribute attribute : node.attributes())
            element->attributes[attribute.name()] = substituted(attribute.value(), *element);
        if (depth == 1 && !source.name.empty()) element->attributes["name"] = source.name;
        if (element->tag == "default") return set_default(*element);
        if (element->tag == "path") return add_folder(*element, source);
        if (element->tag == "include") return include(parent, *element, source, includes);
        for (const pugi::xml_node child : node.children()) read_node(*element, child, source, depth + 1, includes);
        if (source.has_legacy_names) upgrade(*element);
        if (element->tag == "alias") aliases_.emplace_back(element->attribute("as"), element.get());
        parent.children.push_back(std::move(element));
    }

    /// Replaces `$name` and `${name}` by their values.
    std::string substituted(std::string_view text, const Element& element)
    {
        std::string result;
        while (true) {
            const std::size_t dollar = text.find('$');
            result += text.substr(0, dollar);
            if (dollar == std::string_view::npos) return result;
            text.remove_prefix(dollar + 1);
            const bool braces = text.starts_with('{');
            if (braces) text.remove_prefix(1);
            std::size_t length = 0;
            while (length < text.size() &&
                   (std::isalnum(static_cast<unsigned char>(text[length])) || text[length] == '_'))
                ++length;
            const std::string name(text.substr(0, length));
            const auto found = parameters_.find(name);
            if (found == parameters_.end())
                element.fail(fmt::format("the parameter '${}' has no value: give one with -D {}=VALUE", printable(name),
                                         printable(name)));
            used_.insert(name);
            result += found->second;
            text.remove_prefix(length);
            if (braces && text.starts_with('}')) text.remove_prefix(1);
        }
    }

    void set_default(const Element& element)
    {
        if (element.name().empty() || !element.has("value")) element.fail("<default> needs a name and a value");
        known_.insert(element.name());
        if (given_.contains(element.name())) used_.insert(element.name());
        parameters_.emplace(element.name(), element.attribute("value"));
    }

    /// Adds a folder to the search path, before folders added earlier and before the scene's own.
    void add_folder(const Element& element, const Source& source)
    {
        const std::string& value = element.attribute("value");
        std::filesystem::path folder = context_.locate(source.folders.front() / value);
        std::error_code error;
        if (!std::filesystem::exists(folder, error)) folder = document_.locate(value, context_);
        document_.folders.insert(document_.folders.begin(), std::move(folder));
    }

    std::filesystem::path file_to_include(const std::string& name, const Source& source)
    {
        const auto found = first_existing(source.folders, name, context_);
        return found ? *found : document_.locate(name, context_);
    }

    static bool is_object(std::string_view tag)
    {
        constexpr std::string_view tags[] = {"shape",  "bsdf", "emitter", "texture",    "medium",  "sensor",  "phase",
                                             "volume", "film", "sampler", "integrator", "rfilter", "spectrum"};
        return std::ranges::find(tags, tag) != std::end(tags);
    }

    void include(Element& parent, const Element& element, const Source& source, int depth)
    {
        if (!element.has("filename")) element.fail("<include> needs a filename");
        if (depth >= deepest_include)
            element.fail(fmt::format("files include each other more than {} deep", deepest_include));
        const std::filesystem::path file = file_to_include(element.attribute("filename"), source);
        std::string bytes;
        try {
            bytes = context_.read(file);
        } catch (const Error& error) {
            element.fail(error.what());
        }
        read_file_into(parent, file, bytes, depth + 1, &source, element.name());
    }

    void register_ids(const Element& element)
    {
        const std::string& id = element.attribute("id");
        if (!id.empty() && element.tag != "ref" && element.tag != "alias") {
            const auto [found, is_new] = document_.by_id.emplace(id, &element);
            if (!is_new)
                element.fail(fmt::format("the id '{}' is already used: {}", printable(id), found->second->where()));
        }
        for (const auto& child : element.children) register_ids(*child);
    }

    std::map<std::string, std::string> parameters_;
    const std::map<std::string, std::string>& given_;
    std::set<std::string> used_, known_;
    std::vector<std::pair<std::string, const Element*>> aliases_;
    std::size_t elements_ = 0;
    LoadContext& context_;
    Document document_;
};

}  // namespace

const std::string& Element::attribute(std::string_view name) const
{
    const auto found = attributes.find(name);
    return found == attributes.end() ? none : found->second;
}

std::string Element::where() const
{
    return fmt::format("{}: line {}, column {}", place.file ? *place.file : "", place.line, place.column);
}

void Element::fail(const std::string& message) const
{
    throw Error(place.file ? *place.file : "", fmt::format("line {}, column {}", place.line, place.column), message);
}

const Element& Document::find(const Element& reference) const
{
    const auto found = by_id.find(reference.attribute("id"));
    if (found != by_id.end()) return *found->second;
    reference.fail(fmt::format("no element has the id '{}'{}", printable(reference.attribute("id")),
                               suggestion_of(reference.attribute("id"), by_id)));
}

std::filesystem::path Document::locate(const std::string& path, LoadContext& context) const
{
    return first_existing(folders, path, context).value_or(folders.back() / path);
}

Document read_document(const std::filesystem::path& file, const std::string& bytes,
                       const std::map<std::string, std::string>& definitions, LoadContext& context)
{
    return DocumentReader(definitions, context).read(file, bytes);
}

}  // namespace fathom::mitsuba
