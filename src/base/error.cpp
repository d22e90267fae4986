// SPDX-License-Identifier: Apache-2.0
#include "fathom/error.h"

namespace fathom {

namespace {

/// The place, with the middle left out if it is nested hundreds of levels deep.
std::string shortened(const std::string& place)
{
    constexpr std::size_t longest = 200, end = 80;
    return place.size() <= longest ? place : place.substr(0, end) + "..." + place.substr(place.size() - end);
}

std::string line_of(const std::string& file, const std::string& place, const std::string& message)
{
    std::string line;
    for (const std::string& part : {file, shortened(place)})
        if (!part.empty()) line += part + ": ";
    return line + message;
}

}  // namespace

Error::Error(std::string file, std::string place, std::string message)
    : std::runtime_error(line_of(file, place, message)),
      file_(std::move(file)),
      place_(std::move(place)),
      message_(std::move(message))
{
}

}  // namespace fathom
