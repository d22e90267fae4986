#include "fathom/error.h"
#include "fathom/render.h"

namespace fathom {

struct Film::Data {
    RenderSettings settings;
    std::vector<SampleRange> samples;
};
Film::Film(const RenderSettings& settings) : data_(new Data{settings, {}}) {}
Film::Film(Film&&) noexcept = default;
Film& Film::operator=(Film&&) noexcept = default;
Film::~Film() = default;
int Film::width() const { return data_->settings.width; }
int Film::height() const { return data_->settings.height; }
const std::vector<SampleRange>& Film::samples() const { return data_->samples; }
std::uint64_t Film::samples_per_pixel() const { return 1; }
std::uint64_t Film::dropped_samples() const { return 0; }
void Film::merge(const Film&) {}
Image Film::image(bool, bool) const
{
    Image image;
    image.width = width(), image.height = height();
    image.layers.push_back({"", {"R", "G", "B"}, std::vector<float>(std::size_t(width()) * height() * 3, 0.5f)});
    return image;
}
Film::Sums Film::sums() const { return {}; }
Film Film::from_sums(const Sums&) { return Film(RenderSettings{}); }

}  // namespace fathom
