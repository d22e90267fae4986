// SPDX-License-Identifier: Apache-2.0
#include "render/reference.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <cerrno>
#include <cstring>

#include "fathom/denoise.h"
#include "fathom/error.h"
#include "render/overwrite_guard.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

/// A folder for temporary files that is removed with its contents.
class TemporaryFolder {
public:
    TemporaryFolder()
    {
        std::string name = (fs::temp_directory_path() / "fathom-XXXXXX").string();
        if (!mkdtemp(name.data()))
            throw Error(name, "", fmt::format("no folder for temporary files: {}", std::strerror(errno)));
        path_ = name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder()
    {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

/// The format that a render is stored in to be compared with this file.
std::string comparable_format(const fs::path& file, bool is_linear)
{
    std::string extension = file.extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    for (const char* format : {"exr", "hdr", "png", "jpg", "jpeg", "webp", "avif"})
        if (extension == std::string(".") + format) return format;
    return is_linear ? "exr" : "png";
}

}  // namespace

Reference::Reference(const ReferenceOptions& options, int width, int height)
    : reference_(read_comparable(options.file)),
      options_{"", options.tolerance},
      format_(comparable_format(options.file, reference_.image.is_linear))
{
    const Image& image = reference_.image;
    if (image.width != width || image.height != height)
        throw Error(reference_.name, "",
                    fmt::format("the reference is {}x{}, but the image to be rendered is {}x{}", image.width,
                                image.height, width, height));
}

Comparison Reference::compare_with(const Image& image, const Film& film, const WriteOptions& write) const
{
    const TemporaryFolder folder;
    const fs::path file = folder.path() / ("render." + format_);
    WriteOptions options = write;
    options.format.clear();
    write_image(file, format_ == "exr" ? image : display_image(image), options);
    NamedImage stored{read_image(file), "the render"};
    if (stored.image.is_linear) add_variance(stored.image, film);
    return compare(stored, reference_, options_);
}

void check_reference(const RenderOptions& o)
{
    const ReferenceOptions& reference = o.reference;
    if (reference.file.empty()) {
        if (reference.tolerance > 0) throw UsageError("--tolerance: belongs to --reference FILE");
        return;
    }
    if (o.series.frames.size() > 1)
        throw UsageError("--reference: works for one image; compare several with `fathom diff`");
    if (o.only_sample) throw UsageError("--reference: leave it out with --only-sample");
    check_outputs_are_not(o.images.outputs, reference.file, "the reference");
}

}  // namespace fathom::cli
