#pragma once
#include <map>
#include <string>

#include "render/still.h"

namespace fathom::cli {

/// What is made of a film: pictures, and what is told.
class PictureWriter {
public:
    PictureWriter(const RenderOptions& options, const RenderPlan& plan, const PictureOptions& files,
                  Reporter& reporter);

    /// False if a file could not be written, which is told.
    bool write(const Film& film, const Summary& summary);
    /// What a checkpoint of the film says.
    std::map<std::string, std::string> state_attributes(const Film& film, const Summary& summary,
                                                        double samples_per_s) const;
    /// What there is to say once all is written.
    void tell(const Film& film, const Summary& summary, bool cut_short);

private:
    const RenderOptions& o_;
    const RenderPlan& plan_;
    const PictureOptions& files_;
    Reporter& reporter_;
};

}  // namespace fathom::cli
