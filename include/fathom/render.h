#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fathom/api.h"
#include "fathom/costs.h"
#include "fathom/description.h"
#include "fathom/image.h"
#include "fathom/load.h"
#include "fathom/tree_build.h"

namespace fathom {

enum class Filter { box, gaussian, blackman_harris, tent };
/// How far each reaches from the middle, in pixels.
inline constexpr double filter_radii[] = {0.5, 2, 1.65, 1};
inline constexpr double max_filter_radius = 64;

/// How the light is chosen that a surface samples: by power, each as often as any other, or by what it may bring there,
/// which a tree over all lights tells.
enum class LightSelection : std::uint32_t { power, uniform, tree };

/// What is averaged per pixel beside radiance.
enum class Aov { albedo, normal, depth, position, instance_id, material_id };

/// A rectangle of pixels: x0 <= x < x1, y0 <= y < y1.
struct Crop {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// What decides the bits of a picture, beside the scene. `samples` is not among them: see Renderer::render.
struct RenderSettings {
    int width = 800, height = 600;
    std::uint32_t seed = 0;
    int max_depth = -1;      ///< surfaces a path may scatter at; -1: no limit. A limit is bias
    int roulette_depth = 5;  ///< bounces before Russian roulette begins
    bool light_sampling = true;
    LightSelection light_selection = LightSelection::tree;
    /// Paths over the whole picture tell first where light comes from, and all others sample directions and end by
    /// that: less noise where light comes by windows, doors and bright walls, for a quarter to one million paths
    /// more.
    bool guiding = false;
    Filter filter = Filter::blackman_harris;
    double filter_radius = 0;  ///< pixels: the filter is stretched so that it reaches so far; 0: its own
    std::optional<Crop> crop;  ///< only these pixels are rendered; the picture keeps its size
    std::vector<Aov> aovs;
    /// What camera rays that leave the scene see instead of the environment; it lights nothing.
    std::optional<Color> background;
    bool alpha = false;  ///< sums coverage too: the film's picture can have A
    int threads = 0;     ///< 0: available_threads()
    /// The most that a sample may bring of light that comes by two surfaces or more, in each channel: bias, against
    /// fireflies. Light by one surface, or straight to the camera, stays as it is.
    std::optional<float> clamp_indirect;
    /// Rooms of smooth, diffuse quads are rendered by a loop of their own unless this is set: for debugging. The two
    /// compute the same estimator.
    bool general_loop = false;
    bool measure = false;  ///< Progress::costs tells what the stages of rendering take

    /// The pixels that are rendered: the crop, or the whole picture.
    Crop rendered_pixels() const { return crop.value_or(Crop{0, 0, width, height}); }
};

struct CompileStatistics {
    std::size_t triangles = 0, primitives = 0, instances = 0, lights = 0, memory_bytes = 0;
    double build_s = 0;
};

/// A compiled scene: never changed, shared by whoever renders it. Copies refer to the same one.
class FATHOM_API Scene {
public:
    /// camera: name of one of the scene's cameras; empty: the first. Throws Error if the scene can't be rendered
    /// (no camera, NaN positions, index out of range, no memory).
    static Scene compile(const SceneDescription& description, const std::string& camera, Warnings& warnings,
                         TreeBuild build = TreeBuild::standard);

    const CompileStatistics& statistics() const;
    /// The camera that it was compiled for, in world space.
    const Camera& camera() const;
    /// Of all that decides pictures of it, beside camera and settings.
    std::uint64_t fingerprint() const;

    struct Data;
    const Data& data() const { return *data_; }

private:
    friend class SceneEdit;
    std::shared_ptr<const Data> data_;
};

/// What a film is of. Films may be merged if nothing keeps their keys apart.
struct FATHOM_API FilmKey {
    RenderSettings settings;  ///< threads don't count
    std::string scene;        ///< fingerprint of the compiled scene and the camera

    /// As text, for files; parse is its inverse and throws Error if the text is no key, or that of an impossible film.
    std::string text() const;
    static FilmKey parse(const std::string& text);
    /// What keeps two apart, in words ("seed 1, not 0"); empty if nothing does.
    std::string difference(const FilmKey& other) const;
};

/// A picture to be rendered: scene, camera and settings, checked when it is made.
class FATHOM_API RenderJob {
public:
    /// As the camera sees the scene that it was compiled for. Throws Error if that is no picture: a size outside 1x1 to
    /// 65535x65535, a crop that is empty or not inside, numbers of the camera that are not finite in render space.
    RenderJob(const Scene& scene, const RenderSettings& settings);
    /// As another camera sees it, in world space. Throws Error too if something moves and the shutter has other times:
    /// they are compiled into the scene.
    RenderJob(const Scene& scene, const Camera& camera, const RenderSettings& settings);

    const Scene& scene() const;
    const Camera& camera() const;
    const RenderSettings& settings() const { return key().settings; }
    const FilmKey& key() const;

    struct Data;
    const Data& data() const { return *data_; }

private:
    std::shared_ptr<const Data> data_;
};

using SampleRange = std::pair<std::uint64_t, std::uint64_t>;          ///< first, and one past the last
inline constexpr std::uint64_t max_samples = std::uint64_t(1) << 32;  ///< where sample indices end

/// Exact sums of samples: the same whatever the order, the threads, or the parts they came in.
class FATHOM_API Film {
public:
    explicit Film(const RenderJob& job);
    /// One of no samples, to merge others into.
    explicit Film(FilmKey key);
    Film(Film&&) noexcept;
    Film& operator=(Film&&) noexcept;
    ~Film();

    /// Memory of a film of these settings, for each pixel of the picture.
    static std::size_t bytes_per_pixel(const RenderSettings& settings);

    /// Forgets all samples: as a new film of the job, without the cost of new memory where the layout is the same.
    void reset(const RenderJob& job);

    const FilmKey& key() const;
    int width() const;
    int height() const;
    /// Sorted, disjoint, merged where they touch.
    const std::vector<SampleRange>& samples() const;
    std::uint64_t samples_per_pixel() const;
    /// Samples whose value was NaN or infinite; they count as black, which is a bias.
    std::uint64_t dropped_samples() const;
    /// One of them, to be replayed (render_sample); nothing where none was dropped since the film was made.
    struct SampleLocation {
        int x = 0, y = 0;
        std::uint64_t sample = 0;
    };
    std::optional<SampleLocation> dropped_sample() const;

    /// Adds the sums of a film of an equal key over other samples. Throws Error if they overlap or the keys differ.
    void merge(const Film& other);
    /// The same for a film that another process has, in pieces: first its samples, which are checked and count as there
    /// from then on, then the words of all its pixels in any order. Between, the film is of no use.
    ///
    /// dropped_sample  as of dropped_sample()
    void begin_merge(const FilmKey& key, const std::vector<SampleRange>& samples, std::uint64_t dropped,
                     const std::optional<SampleLocation>& dropped_sample);
    void merge_words(std::size_t first_pixel, const std::uint32_t* words, std::size_t pixels);
    /// The words, row by row, as of Sums.
    const std::uint32_t* words() const;
    int words_per_pixel() const;
    /// Adds sums of pixels as this film has them to others.
    void add_words(const std::uint32_t* from, std::uint32_t* to, std::size_t pixels) const;

    /// The mean so far, with A if alpha.
    Image picture(bool alpha) const;
    /// Means so far: the picture (with A if alpha), and a layer per AOV, "variance" (of the mean) if asked for.
    Image image(bool alpha, bool variance) const;

    /// Noise of few samples that are far brighter than those around them.
    struct Fireflies {
        double samples = 0;  ///< their share of all samples, about
        double noise = 0;    ///< their share of the picture's squared error
    };
    /// What of the noise they make: the variance of pixels that is far beyond that of the pixels around, and how many
    /// samples of one height would make it. 0 and 0 below 4 samples a pixel, which tell too little.
    Fireflies fireflies() const;

    /// The sums themselves (film_file.h has them in files): 32-bit words, per pixel `words_per_pixel`.
    struct Sums {
        int width = 0, height = 0, words_per_pixel = 0;
        std::vector<std::uint32_t> words;
        std::vector<SampleRange> samples;
        std::uint64_t dropped = 0;
        std::string key;  ///< FilmKey::text
    };
    Sums sums() const;
    /// Throws Error if they are not the sums of any film: sizes, ranges and the key are checked first.
    static Film from_sums(const Sums& sums);

    struct Data;
    Data& data() { return *data_; }
    const Data& data() const { return *data_; }

private:
    std::unique_ptr<Data> data_;
};

struct Progress {
    std::uint64_t samples_done = 0, samples_total = 0;  ///< samples of pixels, over the whole call
    RenderCosts costs;
};

/// Renders the samples [range.first, range.second) of every pixel into `film`, which must be one of the job. Returns
/// true if done; false if `cancel` became true: then film holds the passes that were finished, which film.samples()
/// tells. Passes are short; where one sample of all pixels takes long, a pass that is cancelled is dropped, for which
/// the film takes as much memory again, if there is so much.
///
/// on_pass  called between passes from the calling thread with the film so far
FATHOM_API bool render(const RenderJob& job, SampleRange range, Film& film, const std::atomic<bool>* cancel = nullptr,
                       const std::function<void(const Progress&, const Film&)>& on_pass = {});

/// Renders the samples of `range`, 1 to 1024 of them, as one pass, for programs that may lose interest in it at any
/// time, as a window whose camera moves. Returns true if done, with the bits that render() makes; false if `cancel`
/// became true, which is looked at between tiles, that is every few milliseconds: `film` is then as it was before.
///
/// A film that has samples takes as much memory again for further ones, and keeps it.
FATHOM_API bool render_pass(const RenderJob& job, SampleRange range, Film& film, const std::atomic<bool>& cancel);

/// One sample of one pixel, radiance in Rec.709: the same value that it has inside a whole picture.
FATHOM_API Color render_sample(const RenderJob& job, int x, int y, std::uint64_t sample_index);

/// Lanes of the kernel that the loader chose on this machine: 32, 16 or 1; and its name: "AVX-512", "AVX2", "base".
FATHOM_API int simd_width();
FATHOM_API const char* simd_name();

}  // namespace fathom
