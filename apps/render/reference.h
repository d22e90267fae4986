// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "options/render_options.h"
#include "render/comparison.h"

namespace fathom::cli {

/// The image of --reference, which a render is compared with.
class Reference {
public:
    /// Reads the image. Throws Error if it can't be read or has another size than the render.
    Reference(const ReferenceOptions& options, int width, int height);

    /// Compares a render as a file of the reference's format would store it: rounded, tone mapped and compressed.
    ///
    /// image  all layers of the render
    /// write  how its files are written
    Comparison compare_with(const Image& image, const Film& film, const WriteOptions& write) const;

private:
    NamedImage reference_;
    CompareOptions options_;
    std::string format_;  ///< the format of the reference, or one that stores as much
};

/// Throws UsageError for options that don't fit a comparison of one image.
void check_reference(const RenderOptions& options);

}  // namespace fathom::cli
