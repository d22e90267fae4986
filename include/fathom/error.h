#pragma once
#include <stdexcept>
#include <string>

#include "fathom/api.h"

namespace fathom {

/// The one exception of Fathom: something outside the program (a file, an option, a machine) is not as it must be.
///
/// what() reads `file: place: message`, leaving out what is empty. The library neither prints nor exits: programs catch
/// this, print what() and choose an exit code.
class FATHOM_API Error : public std::runtime_error {
public:
    /// file     the file or option that is wrong, as the user named it; may be empty
    /// place    where in it: `line 3`, `accessors[7].count`, `--spp`; may be empty
    /// message  what was expected and what was found, in one line
    Error(std::string file, std::string place, std::string message);

    const std::string& file() const { return file_; }
    const std::string& place() const { return place_; }
    const std::string& message() const { return message_; }

private:
    std::string file_, place_, message_;
};

}  // namespace fathom
