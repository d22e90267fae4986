// SPDX-License-Identifier: Apache-2.0
#include "formats/fathom/measured_writer.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

namespace fathom {

namespace {

using namespace std::string_view_literals;

struct TensorField {
    std::string name;
    std::vector<std::size_t> shape;
    std::string bytes;
    std::uint8_t type;
};

TensorField floats(const char* name, std::vector<std::size_t> shape, const std::vector<float>& values)
{
    static_assert(std::endian::native == std::endian::little);
    constexpr std::uint8_t float32 = 10;
    std::string bytes(values.size() * sizeof(float), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return {name, std::move(shape), std::move(bytes), float32};
}

TensorField table(const char* name, std::vector<std::size_t> outer, const MeasuredTable& t)
{
    outer.push_back(std::size_t(t.height)), outer.push_back(std::size_t(t.width));
    return floats(name, std::move(outer), t.values);
}

template <class T>
void put(std::string& to, std::size_t value)
{
    for (std::size_t i = 0; i < sizeof(T); ++i) to += char(value >> (8 * i) & 0xff);
}

}  // namespace

std::string measured_file(const MeasuredBrdf& brdf)
{
    constexpr std::uint8_t uint8 = 1;
    const std::size_t phis = brdf.phi.size(), thetas = brdf.theta.size();
    // Readers require a description. A constant keeps the file unchanged when it is read and written again.
    const std::string name = "a measured surface";
    const TensorField fields[] = {floats("phi_i", {phis}, brdf.phi),
                                  floats("theta_i", {thetas}, brdf.theta),
                                  table("ndf", {}, brdf.ndf),
                                  table("sigma", {}, brdf.sigma),
                                  table("vndf", {phis, thetas}, brdf.vndf),
                                  table("luminance", {phis, thetas}, brdf.luminance),
                                  table("rgb", {phis, thetas, 3}, brdf.color),
                                  {"jacobian", {1}, std::string(1, char(brdf.color_is_per_facet)), uint8},
                                  {"description", {name.size()}, name, uint8}};
    std::size_t offset = 0;
    const auto header = [&] {
        std::string text("tensor_file\0\x01\0"sv);
        std::size_t at = offset;
        put<std::uint32_t>(text, std::size(fields));
        for (const TensorField& field : fields) {
            put<std::uint16_t>(text, field.name.size());
            text += field.name;
            put<std::uint16_t>(text, field.shape.size());
            put<std::uint8_t>(text, field.type);
            put<std::uint64_t>(text, at);
            for (const std::size_t size : field.shape) put<std::uint64_t>(text, size);
            at += field.bytes.size();
        }
        return text;
    };
    // The header's length doesn't depend on the offsets in it.
    offset = header().size();
    std::string bytes = header();
    for (const TensorField& field : fields) bytes += field.bytes;
    return bytes;
}

}  // namespace fathom
