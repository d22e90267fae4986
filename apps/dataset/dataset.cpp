// SPDX-License-Identifier: Apache-2.0
#include "dataset/dataset.h"

#include <fmt/format.h>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>

#include "dataset/dataset_writer.h"
#include "dataset/model_list.h"
#include "fathom/error.h"
#include "process/interrupt.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The number of views, as in `1 view` or `12 views`.
std::string views_text(const ModelViews& views)
{
    return fmt::format("{} view{}", views.count(), views.count() == 1 ? "" : "s");
}

/// File that completes the folder of a data set and describes it.
constexpr const char* description_file = "dataset.json";

/// Options that decide the contents of a data set, for comparison with an earlier run.
Json settings_of(const RenderOptions& o)
{
    const DatasetOptions& d = o.dataset;
    Json settings{{"format", dataset_format_names[std::size_t(d.format) - 1]}, {"seed", o.settings.seed}};
    if (d.views > 0) {
        settings["views"] = d.views;
        settings["on"] = view_placement_names[std::size_t(d.placement)];
    }
    if (!d.cameras.empty()) settings["cameras"] = d.cameras.string();
    if (!o.series.frames.empty()) settings["frames"] = o.series.frames;
    if (o.scene.size) settings["size"] = {o.scene.size->width, o.scene.size->height};
    if (o.samples.samples) settings["spp"] = *o.samples.samples;
    return settings;
}

/// Whether a folder holds the complete data set of a model. Throws Error if it holds something else.
bool is_complete(const fs::path& folder, const RenderOptions& o)
{
    std::error_code error;
    if (!fs::exists(folder, error) || fs::is_empty(folder, error)) return false;
    std::ifstream stream(folder / description_file);
    const Json earlier = stream ? Json::parse(stream, nullptr, false) : Json();
    if (!earlier.is_object() || !earlier.contains("settings"))
        throw Error(folder.string(), "", "the folder contains other files; choose a new folder for the data set");
    if (earlier["settings"] != settings_of(o))
        throw Error(folder.string(), "",
                    fmt::format("the folder contains a data set of other settings ({}); choose a new folder",
                                earlier["settings"].dump()));
    return true;
}

/// A model that is ready to be rendered.
struct PreparedModel {
    std::unique_ptr<ModelViews> views;
    std::vector<std::string> notes;
    double load_s = 0;
};

PreparedModel prepare(const RenderOptions& options, const fs::path& file)
{
    const double start_s = seconds_since_start();
    PreparedModel model;
    Reporter reporter(ReportMode::silent);
    reporter.forward(
        {.note = [&](const std::string& note) { model.notes.push_back(note); }, .error = {}, .warnings = {}});
    RenderOptions o = options;
    o.scene.file = file;
    o.samples.part.reset();
    Warnings warnings;
    SceneFileContents contents = load_scene_file(file, load_options(o.scene), warnings);
    model.views = std::make_unique<ModelViews>(o, std::move(contents), reporter);
    for (const auto& [text, times] : warnings.counts()) model.views->add_warning(text, times);
    model.load_s = seconds_since_start() - start_s;
    return model;
}

Json description_of(const RenderOptions& o, const ModelViews& views, const std::vector<SceneObject>& objects)
{
    Json all{{"fathom", FATHOM_VERSION},   {"model", views.plan().scene_options.file.string()},
             {"settings", settings_of(o)}, {"views", views.count()},
             {"objects", Json::array()},   {"materials", Json::array()},
             {"warnings", Json::array()}};
    for (const SceneObject& object : objects)
        all["objects"].push_back({{"instance", all["objects"].size() + 1}, {"name", object.name}});
    for (const Material& material : views.description().materials)
        all["materials"].push_back({{"material", all["materials"].size() + 1}, {"name", material.name}});
    for (const auto& [text, times] : views.warnings().counts()) all["warnings"].push_back(text);
    return all;
}

TruthRequest request_of(const DatasetWriter& writer, const DatasetOptions& o)
{
    TruthRequest request = writer.request();
    request.layers |= !o.layers.empty();
    for (const TruthLayer layer : o.layers) request.flow |= layer == TruthLayer::flow;
    return request;
}

/// A folder for the files of an unfinished data set, which is removed unless it is completed.
class PartialFolder {
public:
    explicit PartialFolder(const fs::path& folder) : folder_(folder), path_(folder)
    {
        path_ += ".partial";
        fs::remove_all(path_);
        fs::create_directories(path_);
    }
    PartialFolder(const PartialFolder&) = delete;
    PartialFolder& operator=(const PartialFolder&) = delete;
    ~PartialFolder()
    {
        std::error_code error;
        fs::remove_all(path_, error);
    }
    const fs::path& path() const { return path_; }
    /// Gives the folder its name. An empty folder of this name may be there.
    void complete()
    {
        fs::remove(folder_);
        fs::rename(path_, folder_);
    }

private:
    fs::path folder_, path_;
};

/// Renders a model to a folder, which appears under its name when it is complete. Returns the seconds of rendering, or
/// nothing after an interrupt.
std::optional<double> render_model(const RenderOptions& o, ModelViews& views, const fs::path& folder,
                                   Reporter& reporter)
{
    PartialFolder partial(folder);
    const fs::path& path = partial.path();
    const auto writer = make_dataset_writer(o.dataset.format, path, views.count(), views.plan(), views.description());
    const TruthRequest request = request_of(*writer, o.dataset);
    const bool has_layers = !o.dataset.layers.empty() || !o.film.aovs.empty();
    double render_s = 0;
    std::vector<SceneObject> objects;
    for (std::size_t i = 0; i < views.count(); ++i) {
        const std::optional<View> view = views.render(i, request, interrupted(), reporter);
        if (!view) return {};
        writer->add(*view);
        if (has_layers) {
            fs::create_directories(path / "exr");
            write_image(path / "exr" / fmt::format("{:06}.exr", i), view->image, views.plan().write);
        }
        render_s += view->summary.render_s;
        objects = view->objects;
    }
    writer->finish();
    write_json(path / description_file, description_of(o, views, objects));
    partial.complete();
    return render_s;
}

/// Renders the models of a list. The next one is read while one is rendered.
class ListRender {
public:
    ListRender(const RenderOptions& o, Reporter& reporter)
        : o_(o), reporter_(reporter), folder_(o.images.outputs[0]), silent_(ReportMode::silent)
    {
        const std::vector<ListedModel> all = read_model_list(o.dataset.models);
        models_ = models_of_part(all, o.samples.part);
        fs::create_directories(folder_);
        log_.emplace(folder_, o.samples.part);
    }

    int run()
    {
        choose_models();
        start_next(0);
        for (std::size_t i = 0; i < models_.size() && !interrupted(); ++i) take(i);
        if (interrupted()) return exit_interrupted;
        std::string text = fmt::format("{} of {} models rendered", done_, done_ + failed_);
        if (failed_ > 0) text += fmt::format("; {} failed, see {}", failed_, log_->file().string());
        reporter_.note(text);
        return failed_ > 0 ? exit_error : exit_ok;
    }

private:
    /// Leaves out what is complete, or ended the process twice. Models that ended it once come last, one by one.
    void choose_models()
    {
        std::vector<ListedModel> fresh, suspicious;
        std::size_t complete = 0;
        for (const ListedModel& model : models_) {
            const int starts = log_->unfinished_starts(model.name);
            try {
                if (is_complete(folder_ / model.name, o_))
                    ++complete;
                else if (starts >= 2)
                    fail(model, "the program ended twice while this model was read or rendered", true);
                else
                    (starts > 0 ? suspicious : fresh).push_back(model);
            } catch (const std::exception& error) {
                fail(model, error.what());
            }
        }
        if (complete > 0) reporter_.note(fmt::format("{} of {} models are complete already", complete, models_.size()));
        alone_from_ = fresh.size();
        models_ = std::move(fresh);
        models_.insert(models_.end(), suspicious.begin(), suspicious.end());
    }

    void start_next(std::size_t i)
    {
        if (i >= models_.size()) return;
        log_->started(models_[i]);
        next_ = std::async(std::launch::async, [this, i] { return prepare(o_, models_[i].file); });
    }

    void take(std::size_t i)
    {
        const ListedModel& model = models_[i];
        const bool next_is_alone = i + 1 >= alone_from_;
        try {
            PreparedModel prepared = next_.get();
            if (!next_is_alone) start_next(i + 1);
            render(model, prepared);
        } catch (const std::exception& error) {
            fail(model, error.what());
            if (!next_is_alone && !next_.valid()) start_next(i + 1);
        }
        if (interrupted()) {
            if (!next_is_alone && i + 1 < models_.size()) log_->interrupted(models_[i + 1]);
        } else if (next_is_alone) {
            start_next(i + 1);
        }
    }

    void render(const ListedModel& model, PreparedModel& prepared)
    {
        const std::optional<double> render_s = render_model(o_, *prepared.views, folder_ / model.name, silent_);
        if (!render_s) return log_->interrupted(model);
        ++done_;
        Json warnings = Json::array();
        for (const auto& [text, times] : prepared.views->warnings().counts()) warnings.push_back(text);
        log_->done(model, {{"views", prepared.views->count()},
                           {"load_s", prepared.load_s},
                           {"render_s", *render_s},
                           {"warnings", warnings}});
        reporter_.note(fmt::format("{} ({} of {}): {} in {:.1f} s", model.name, done_ + failed_, models_.size(),
                                   views_text(*prepared.views), *render_s));
    }

    void fail(const ListedModel& model, const std::string& error, bool ended_process = false)
    {
        ++failed_;
        log_->failed(model, error, ended_process);
        reporter_.error(fmt::format("{}: {}", model.name, error));
    }

    const RenderOptions& o_;
    Reporter& reporter_;
    const fs::path folder_;
    Reporter silent_;
    std::vector<ListedModel> models_;
    std::size_t alone_from_ = 0;  ///< models from this one on are read after the one before is done
    std::optional<ModelLog> log_;
    std::future<PreparedModel> next_;
    std::size_t done_ = 0, failed_ = 0;
};

int render_single(const RenderOptions& o, Reporter& reporter)
{
    const fs::path folder =
        o.images.outputs[0].has_filename() ? o.images.outputs[0] : o.images.outputs[0].parent_path();
    if (is_complete(folder, o)) {
        reporter.note(fmt::format("{} is complete already", folder.string()));
        return exit_ok;
    }
    const PreparedModel prepared = [&] {
        const Reporter::Phase phase(reporter, "load", "reading " + o.scene.file.string());
        return prepare(o, o.scene.file);
    }();
    for (const std::string& note : prepared.notes) reporter.note(note);
    reporter.warnings(prepared.views->warnings());
    const std::optional<double> render_s = render_model(o, *prepared.views, folder, reporter);
    if (!render_s) return exit_interrupted;
    reporter.written(folder.string());
    reporter.note(
        fmt::format("{} in {:.1f} s, read in {:.1f} s", views_text(*prepared.views), *render_s, prepared.load_s));
    return exit_ok;
}

}  // namespace

int render_dataset(const RenderOptions& options, Reporter& reporter)
{
    RenderOptions o = options;
    const ThreadLimit limit = limit_threads(o.settings, reporter);
    finish_on_interrupt(reporter.mode() == ReportMode::json
                            ? "{\"event\":\"interrupted\"}\n"
                            : "\nfathom: interrupted: the current model will be rendered anew next time\n");
    return o.dataset.models.empty() ? render_single(o, reporter) : ListRender(o, reporter).run();
}

}  // namespace fathom::cli
