// SPDX-License-Identifier: Apache-2.0
#include "base/text_file.h"

#include "base/output_file.h"

namespace fathom {

void write_text_file(const std::filesystem::path& file, std::string_view text)
{
    OutputFile output(file);
    output.write(text.data(), text.size());
    output.commit();
}

}  // namespace fathom
