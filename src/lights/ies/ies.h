#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// What a luminaire sends in each direction, as a file of IES LM-63 (1986 to 2019) says it: type C photometry.
struct IesProfile {
    std::vector<double> polar_deg;    ///< angles from the nadir, ascending, two at least
    std::vector<double> azimuth_deg;  ///< angles about it, ascending; what lies beyond the last follows by symmetry
    /// Candela, those of all polar angles for the first azimuth, then for the next. The file's factors are in it.
    std::vector<double> candela;

    /// Between the file's angles it changes linearly in both; 0 beyond its polar angles.
    double at(double polar_deg, double azimuth_deg) const;
};

/// Whether the name of a file says that it is one.
bool is_ies_name(std::string_view name);

/// Throws Error, naming `name`, for what is no such file, is damaged, or of type A or B. Tilt is left out, as programs
/// do: it says how a lamp's flux depends on how the luminaire hangs.
IesProfile parse_ies(const std::string& name, std::string_view text);
IesProfile read_ies(const std::filesystem::path& file);

}  // namespace fathom
