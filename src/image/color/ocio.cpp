// SPDX-License-Identifier: Apache-2.0
#include "image/color/ocio.h"

#include "fathom/error.h"

#ifdef FATHOM_HAS_OCIO
#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include "image/color/primaries.h"
#endif

namespace fathom {

#ifdef FATHOM_HAS_OCIO

namespace ocio = OCIO_NAMESPACE;

namespace {

/// Names of linear Rec.709 in common configurations: those of ACES (and aliases since version 2), of Blender, and of
/// OpenColorIO's own tools.
constexpr const char* usual_inputs[] = {"lin_rec709",
                                        "lin_rec709_scene",
                                        "lin_srgb",
                                        "Linear Rec.709",
                                        "Linear Rec.709 (sRGB)",
                                        "linear_srgb",
                                        "Linear sRGB",
                                        "scene_linear_rec709_srgb",
                                        "Utility - Linear - sRGB",
                                        "Utility - Linear - Rec.709"};

/// Primaries of ACES2065-1: AP0 (SMPTE ST 2065-1).
constexpr Chromaticities aces_chromaticities{{0.7347f, 0.2653f}, {0, 1}, {0.0001f, -0.077f}, {0.32168f, 0.33767f}};

using Names = std::vector<std::string>;

/// Returns the name if it is among `names`. Throws an Error that lists them otherwise.
std::string chosen(const std::string& file, const char* what, const std::string& name, const Names& names)
{
    if (std::find(names.begin(), names.end(), name) != names.end()) return name;
    throw Error(file, "", fmt::format("there is no {} '{}'; there are: {}", what, name, fmt::join(names, ", ")));
}

template <class NameAt>
Names names_of(int count, NameAt name_at)
{
    Names names;
    for (int i = 0; i < count; ++i) names.emplace_back(name_at(i));
    return names;
}

Names color_spaces(const ocio::Config& config)
{
    return names_of(config.getNumColorSpaces(), [&](int i) { return config.getColorSpaceNameByIndex(i); });
}

/// The configuration's input color space, and the transform to it from linear Rec.709.
struct Input {
    std::string space;
    ocio::TransformRcPtr transform;  ///< none if the space is linear Rec.709
};

ocio::TransformRcPtr aces_from_rec709()
{
    const ColorMatrix matrix = conversion(rec709_chromaticities, aces_chromaticities);
    double rows[16] = {};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) rows[4 * i + k] = matrix[i][k];
    rows[15] = 1;
    const ocio::MatrixTransformRcPtr transform = ocio::MatrixTransform::Create();
    transform->setMatrix(rows);
    return transform;
}

Input find_input(const ocio::Config& config, const std::string& file, const std::string& name)
{
    if (!name.empty()) {
        if (const auto space = config.getColorSpace(name.c_str())) return {space->getName(), nullptr};
        chosen(file, "color space", name, color_spaces(config));
    }
    for (const char* const usual : usual_inputs)
        if (const auto space = config.getColorSpace(usual)) return {space->getName(), nullptr};
    if (config.hasRole(ocio::ROLE_INTERCHANGE_SCENE))
        return {config.getColorSpace(ocio::ROLE_INTERCHANGE_SCENE)->getName(), aces_from_rec709()};
    throw Error(file, "",
                fmt::format("none of its color spaces is known to be linear Rec.709; choose it with --ocio-input: {}",
                            fmt::join(color_spaces(config), ", ")));
}

class Processor : public OcioView {
public:
    Processor(ocio::ConstCPUProcessorRcPtr processor, std::string text)
        : processor_(std::move(processor)), text_(std::move(text))
    {
    }
    void apply(float rgb[3]) const override { processor_->applyRGB(rgb); }
    std::string text() const override { return text_; }

private:
    ocio::ConstCPUProcessorRcPtr processor_;
    std::string text_;
};

std::shared_ptr<const OcioView> open_view(const OcioChoice& choice, const std::string& file)
{
    const ocio::ConstConfigRcPtr config = ocio::Config::CreateFromFile(file.c_str());
    const Names displays = names_of(config->getNumDisplays(), [&](int i) { return config->getDisplay(i); });
    const std::string display =
        chosen(file, "display", choice.display.empty() ? config->getDefaultDisplay() : choice.display, displays);
    const Names views =
        names_of(config->getNumViews(display.c_str()), [&](int i) { return config->getView(display.c_str(), i); });
    const std::string view =
        chosen(file, "view", choice.view.empty() ? config->getDefaultView(display.c_str()) : choice.view, views);
    const Input input = find_input(*config, file, choice.input);

    const ocio::GroupTransformRcPtr group = ocio::GroupTransform::Create();
    if (input.transform) group->appendTransform(input.transform);
    if (!choice.look.empty()) {
        const ocio::LookTransformRcPtr look = ocio::LookTransform::Create();
        look->setSrc(input.space.c_str());
        look->setDst(input.space.c_str());
        const Names looks = names_of(config->getNumLooks(), [&](int i) { return config->getLookNameByIndex(i); });
        look->setLooks(chosen(file, "look", choice.look, looks).c_str());
        group->appendTransform(look);
    }
    const ocio::DisplayViewTransformRcPtr transform = ocio::DisplayViewTransform::Create();
    transform->setSrc(input.space.c_str());
    transform->setDisplay(display.c_str());
    transform->setView(view.c_str());
    transform->setLooksBypass(!choice.look.empty());
    group->appendTransform(transform);
    // The optimization must be lossless: the other levels approximate powers.
    const auto processor = config->getProcessor(group)->getOptimizedCPUProcessor(ocio::OPTIMIZATION_LOSSLESS);
    std::string text = fmt::format("{}: display '{}', view '{}'", file, display, view);
    if (!choice.look.empty()) text += fmt::format(", look '{}'", choice.look);
    text += fmt::format(", from linear Rec.709 {} '{}'", input.transform ? "by way of" : "as", input.space);
    return std::make_shared<Processor>(processor, text);
}

}  // namespace

std::shared_ptr<const OcioView> open_ocio(const OcioChoice& choice)
{
    std::string file = choice.config;
    if (file.empty()) {
        const char* const variable = std::getenv("OCIO");
        if (!variable || !*variable)
            throw Error("", "OCIO", "this variable is not set: give an OpenColorIO configuration with --ocio CONFIG");
        file = variable;
    }
    try {
        return open_view(choice, file);
    } catch (const ocio::Exception& error) {
        std::string message = error.what();
        std::replace(message.begin(), message.end(), '\n', ' ');
        throw Error(file, "", fmt::format("this OpenColorIO configuration can't be used: {}", message));
    }
}

#else

std::shared_ptr<const OcioView> open_ocio(const OcioChoice&)
{
    throw Error("", "", "this build has no OpenColorIO: build Fathom from source with libopencolorio-dev installed");
}

#endif

std::string ocio_text(const OcioView& view)
{
    return view.text();
}

}  // namespace fathom
