// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

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

/// Place and message of the error that reading a file gives, which names that file on one line; "loaded" if it gives
/// none.
inline std::string error_in_file(const std::string& file, const std::function<void()>& read)
{
    try {
        read();
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        // The error stays short enough to read however deep its place is nested.
        EXPECT_LT(std::string(e.what()).size(), 600u) << e.what();
        EXPECT_EQ(e.file(), file);
        return (e.place().empty() ? "" : e.place() + ": ") + e.message();
    }
    return "loaded";
}

}  // namespace fathom::test
