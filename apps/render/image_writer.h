// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>

#include "render/error_watch.h"
#include "render/still.h"

namespace fathom::cli {

/// The watched error of a render that has ended, and why it ended.
struct ErrorEnd {
    const ErrorWatch& watch;
    const char* end = "";  ///< why the render ended, unless the error was reached
};

/// Makes images and reports of a film.
class ImageWriter {
public:
    ImageWriter(const RenderPlan& plan, const ImageOptions& files, Reporter& reporter);

    /// Adds the layers of ground truth to all images from here on.
    void add_ground_truth(const RenderJob& job);
    /// The image of a film: its layers, those of the options, attributes, and the denoised layer if there is a
    /// denoiser.
    Image image(const Film& film, const Summary& summary) const;
    /// False if a file could not be written, which is reported.
    bool write(const Film& film, const Summary& summary);
    /// Compares with the plan's reference, and reports it; true if there is none or no pixel differs.
    bool is_like_reference(const Film& film, const Summary& summary) const;
    /// Attributes of a checkpoint of the film.
    std::map<std::string, std::string> checkpoint_attributes(const Film& film, const Summary& summary,
                                                             double samples_per_s) const;
    /// Reports the error, fireflies and dropped samples.
    void report_noise(const Film& film, const ErrorEnd& error);
    /// Reports the render once all is written.
    void report_result(const Film& film, const Summary& summary, bool was_interrupted, const ErrorEnd& error);

private:
    const RenderPlan& plan_;
    const ImageOptions& files_;
    Reporter& reporter_;
    std::vector<Image::Layer> truth_;
};

}  // namespace fathom::cli
