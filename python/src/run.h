// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fathom/denoise.h"
#include "film.h"
#include "render/image_writer.h"
#include "render/render_plan.h"
#include "scene.h"

namespace fathom::python {

/// How an image is converted for a display, resolved again for each set of options.
struct DisplayChoice {
    RenderHints hints;                  ///< of the scene
    std::optional<double> exposure_ev;  ///< exposure that was found for the scene's light

    /// words  options of an image, as `fathom render` has them
    WriteOptions resolve(const std::vector<std::string>& words) const;
};

/// One call of render(): its options, the film, and the image of the samples so far.
class Run {
public:
    using AfterPass = std::function<void(const Film&)>;

    /// Prepares the scene and renders the samples that the options ask for. It stops soon after `cancel` becomes true.
    ///
    /// words   options of `fathom render`
    /// take    the scene may be taken apart, since it isn't used afterwards
    /// resume  film whose samples are not rendered again; nullptr: none
    void start(Scene& scene, const std::vector<std::string>& words, bool take, const Film* resume,
               const std::atomic<bool>& cancel, const AfterPass& after_pass);
    /// Renders more samples. Throws Error if the scene was compiled anew since start().
    ///
    /// samples  number of samples per pixel; none: as many as fit into time_s
    void more(std::optional<std::uint64_t> samples, std::optional<double> time_s, const std::atomic<bool>& cancel,
              const AfterPass& after_pass);
    /// The scene that is rendered; null after forget_scene().
    const std::shared_ptr<PreparedScene>& prepared() const { return prepared_; }
    /// The image so far; its layers never change.
    std::shared_ptr<const Image> image() const { return image_; }
    /// Forgets the scene, after which no more samples can be rendered.
    void forget_scene();

    std::shared_ptr<FilmBox> film;
    DisplayChoice display;
    std::vector<std::string> notes;  ///< what was added and decided, in sentences
    Warnings warnings;
    double planned_samples = 0;  ///< samples per pixel that start() renders; 0: as many as fit into a time
    bool is_busy = false;        ///< a thread renders; read and written with the interpreter lock

private:
    void prepare(Scene& scene, const std::vector<std::string>& scene_words, bool take);
    void compile_first(PreparedScene& prepared);
    void sample(SampleRange wanted, std::optional<double> time_s, const std::atomic<bool>& cancel,
                const AfterPass& after_pass);

    cli::RenderOptions options_;
    cli::Reporter reporter_{cli::ReportMode::silent};
    std::shared_ptr<PreparedScene> prepared_;
    std::optional<cli::RenderPlan> plan_;
    SharedJob job_;
    cli::Summary summary_;
    std::shared_ptr<const Image> image_;
};

}  // namespace fathom::python
