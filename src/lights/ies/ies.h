// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fathom {

/// Luminous intensity of a luminaire by direction, from an IES LM-63 file (1986 to 2019): type C photometry.
struct IesProfile {
    std::vector<double> polar_deg;    ///< angles from the nadir, ascending, at least two
    std::vector<double> azimuth_deg;  ///< angles about the vertical, ascending; other angles follow by symmetry
    /// Candela for all polar angles of the first azimuth, then of the next; the file's factors are applied.
    std::vector<double> candela;

    /// Luminous intensity, interpolated bilinearly between the file's angles; 0 outside the polar angles.
    double at(double polar_deg, double azimuth_deg) const;
};

/// Whether a file name has the extension .ies.
bool is_ies_name(std::string_view name);

/// Throws Error, naming `name`, for files that are not IES, damaged, or of type A or B. Tilt is ignored, as in other
/// programs: it states how the lamp's flux depends on the orientation of the luminaire.
IesProfile parse_ies(const std::string& name, std::string_view text);
/// Reads a profile from a file; throws Error as parse_ies.
IesProfile read_ies(const std::filesystem::path& file);

}  // namespace fathom
