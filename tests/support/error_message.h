// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

#include "fathom/error.h"

namespace fathom::test {

/// The error that an action throws; an error with empty texts if it throws none.
inline Error error_of(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    return {"", "", ""};
}

/// Message of the error that an action throws, with file and place.
inline std::string error_text(const std::function<void()>& action)
{
    return error_of(action).what();
}

/// Message of the error that an action throws, without file and place.
inline std::string error_message(const std::function<void()>& action)
{
    return error_of(action).message();
}

}  // namespace fathom::test
