// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stdexcept>
#include <string>

#include "fathom/api.h"

namespace fathom {

/// The exception that the library throws if something outside the program is wrong: a file, an option, the machine.
///
/// what() is one line, `file: place: message`, without the parts that are empty. The library neither prints nor exits:
/// programs catch Error, print what() and choose an exit code. Errors of the calling code, such as an index out of
/// range, throw standard exceptions.
class FATHOM_API Error : public std::runtime_error {
public:
    /// Creates an error.
    ///
    /// file     File or option that is wrong, as the user named it; may be empty.
    /// place    Where in it, such as `line 3`, `accessors[7].count` or `--spp`; may be empty. what() shortens places of
    ///          more than 200 characters.
    /// message  What was expected and what was found, in one line.
    Error(std::string file, std::string place, std::string message);

    /// Returns the file or option that is wrong; may be empty.
    const std::string& file() const { return file_; }
    /// Returns the place in the file; may be empty.
    const std::string& place() const { return place_; }
    /// Returns the message without file and place.
    const std::string& message() const { return message_; }

private:
    std::string file_, place_, message_;
};

}  // namespace fathom
