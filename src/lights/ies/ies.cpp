// SPDX-License-Identifier: Apache-2.0
#include "lights/ies/ies.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include "fathom/error.h"

namespace fathom {

namespace {

/// The size of the file is limited: IES files hold at most some hundred thousand numbers.
constexpr std::uintmax_t largest_file = std::uintmax_t(64) << 20;

constexpr double largest_candela = 1e18;

bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',';
}

/// Parses the header lines up to TILT, then numbers, which may be split into lines anywhere.
class IesReader {
public:
    IesReader(const std::string& name, std::string_view text) : name_(name), text_(text) {}

    IesProfile read()
    {
        read_head();
        next("number of lamps");
        next("lumens per lamp");
        double factor = positive("candela multiplier");
        const std::size_t polar = count("number of vertical angles"), azimuth = count("number of horizontal angles");
        const double type = next("photometric type");
        if (type == 2 || type == 3)
            fail(fmt::format("is of type {} photometry; only type C is read", type == 2 ? 'B' : 'A'));
        if (type != 1) fail(fmt::format("the photometric type {} is not one of 1, 2, 3", type));
        for (const char* what : {"unit", "width", "length", "height"}) next(what);
        factor *= positive("ballast factor");
        const double photometric = next("ballast-lamp photometric factor");
        if (has_photometric_factor_ && photometric > 0) factor *= photometric;
        next("input watts");
        if (polar < 2) fail("it has fewer than two vertical angles");
        check_room(polar, azimuth);
        IesProfile profile;
        read_angles("vertical", polar, 180, profile.polar_deg);
        read_angles("horizontal", azimuth, 360, profile.azimuth_deg);
        profile.candela.reserve(polar * azimuth);
        for (std::size_t i = 0; i < polar * azimuth; ++i) {
            const double value = next("candela value");
            if (!(value >= 0)) fail(fmt::format("the candela value {} of {} is negative", i + 1, polar * azimuth));
            if (!(value * factor <= largest_candela))
                fail(fmt::format("the candela value {} of {} is {:g}, which is too large", i + 1, polar * azimuth,
                                 value * factor));
            profile.candela.push_back(value * factor);
        }
        return profile;
    }

private:
    [[noreturn]] void fail(const std::string& message) const { throw Error(name_, "", "IES: " + message); }

    std::string_view line()
    {
        const std::size_t end = std::min(text_.find('\n', at_), text_.size());
        std::string_view found = text_.substr(at_, end - at_);
        at_ = std::min(end + 1, text_.size());
        while (!found.empty() && is_blank(found.back())) found.remove_suffix(1);
        return found;
    }

    void read_head()
    {
        const std::size_t begin = text_.starts_with("\xef\xbb\xbf") ? 3 : 0;
        at_ = begin;
        // Later versions of the standard gave this factor another meaning, in which it must not be applied.
        has_photometric_factor_ = !text_.substr(begin).starts_with("IES") || text_.substr(begin).starts_with("IESNA91");
        while (at_ < text_.size()) {
            const std::string_view found = line();
            if (!found.starts_with("TILT=")) continue;
            if (found.substr(5) != "INCLUDE") return;
            next("lamp to luminaire geometry of the tilt");
            const std::size_t pairs = count("number of tilt angles");
            check_room(pairs, 2);
            for (std::size_t i = 0; i < 2 * pairs; ++i) next("tilt");
            return;
        }
        fail("no line begins with TILT=: it is not a photometric file");
    }

    double next(const char* what)
    {
        while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
        if (at_ == text_.size()) fail(fmt::format("it ends where its {} should be", what));
        std::size_t end = at_;
        while (end < text_.size() && !is_blank(text_[end])) ++end;
        std::string_view word = text_.substr(at_, end - at_);
        at_ = end;
        if (word.starts_with('+')) word.remove_prefix(1);
        double value = 0;
        const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
        if (result.ec != std::errc() || result.ptr != word.data() + word.size() || !std::isfinite(value))
            fail(fmt::format("its {} is not a number", what));
        return value;
    }

    double positive(const char* what)
    {
        const double value = next(what);
        if (!(value > 0)) fail(fmt::format("its {} is {}; it must be above 0", what, value));
        return value;
    }

    std::size_t count(const char* what)
    {
        const double value = next(what);
        if (!(value >= 1 && value <= 1e9 && value == std::floor(value)))
            fail(fmt::format("its {} is {}; it must be a whole number above 0", what, value));
        return std::size_t(value);
    }

    /// Every number takes at least two bytes, so the file's size limits the memory that a damaged file can request.
    void check_room(std::size_t columns, std::size_t rows) const
    {
        if (double(columns) * double(rows) > double(text_.size() - at_))
            fail(fmt::format("its header says {} by {} values, but it ends after {} bytes", columns, rows,
                             text_.size()));
    }

    void read_angles(const char* what, std::size_t size, double most, std::vector<double>& angles)
    {
        for (std::size_t i = 0; i < size; ++i) {
            const double angle = next(what == std::string_view("vertical") ? "vertical angles" : "horizontal angles");
            if (!(angle >= 0 && angle <= most))
                fail(fmt::format("the {} angle {} is not within 0 and {} degrees", what, angle, most));
            if (!angles.empty() && angle <= angles.back())
                fail(fmt::format("the {} angle {} follows {}: they must increase", what, angle, angles.back()));
            angles.push_back(angle);
        }
    }

    const std::string& name_;
    std::string_view text_;
    std::size_t at_ = 0;
    bool has_photometric_factor_ = false;
};

/// Two neighboring angles, and the weight of the second.
struct Between {
    std::size_t a, b;
    double share;
};
Between between(const std::vector<double>& angles, double angle)
{
    if (angle <= angles.front()) return {0, 0, 0};
    if (angle >= angles.back()) return {angles.size() - 1, angles.size() - 1, 0};
    const std::size_t b = std::size_t(std::upper_bound(angles.begin(), angles.end(), angle) - angles.begin());
    return {b - 1, b, (angle - angles[b - 1]) / (angles[b] - angles[b - 1])};
}

}  // namespace

double IesProfile::at(double polar, double azimuth) const
{
    if (polar < polar_deg.front() || polar > polar_deg.back()) return 0;
    azimuth -= 360 * std::floor(azimuth / 360);
    const double first = azimuth_deg.front(), last = azimuth_deg.back();
    if (last <= 90 && azimuth > 180) azimuth = 360 - azimuth;  // azimuths that are symmetric about both planes
    if (last <= 90 && azimuth > 90) azimuth = 180 - azimuth;
    if (first == 0 && last > 90 && last <= 180 && azimuth > 180)
        azimuth = 360 - azimuth;       // azimuths that are symmetric about the plane of 0 and 180 degrees
    if (first == 90 && last == 270) {  // azimuths that are symmetric about the plane of 90 and 270 degrees
        if (azimuth < 90) azimuth = 180 - azimuth;
        if (azimuth > 270) azimuth = 540 - azimuth;
    }
    Between h = between(azimuth_deg, azimuth);
    // The file covers the full circle without repeating the first angle at 360 degrees.
    if (last > 180 && last < 360 && azimuth > last && !(first == 90 && last == 270))
        h = {azimuth_deg.size() - 1, 0, (azimuth - last) / (first + 360 - last)};
    const Between v = between(polar_deg, polar);
    const auto row = [&](std::size_t i) {
        const double* const values = &candela[i * polar_deg.size()];
        return values[v.a] + v.share * (values[v.b] - values[v.a]);
    };
    return row(h.a) + h.share * (row(h.b) - row(h.a));
}

bool is_ies_name(std::string_view name)
{
    constexpr std::string_view ending = ".ies";
    if (name.size() < ending.size()) return false;
    const std::string_view end = name.substr(name.size() - ending.size());
    return std::equal(end.begin(), end.end(), ending.begin(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? char(a - 'A' + 'a') : a) == b; });
}

IesProfile parse_ies(const std::string& name, std::string_view text)
{
    return IesReader(name, text).read();
}

IesProfile read_ies(const std::filesystem::path& file)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) throw Error(file.string(), "", "there is no such file");
    if (std::filesystem::file_size(file, error) > largest_file)
        throw Error(file.string(), "", "IES: it is too large for a photometric file");
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (!in && text.empty()) throw Error(file.string(), "", "can't be read");
    return parse_ies(file.string(), text);
}

}  // namespace fathom
