#include "fathom/error.h"
#include "fathom/render.h"

namespace fathom {

struct Scene::Data {
    SceneStatistics statistics;
    Camera camera;
};

Scene Scene::compile(const SceneDescription& description, const std::string&, Warnings&)
{
    Scene scene;
    scene.data_ = std::make_shared<Data>();
    if (!description.cameras.empty()) scene.data_->camera = description.cameras[0];
    return scene;
}
const SceneStatistics& Scene::statistics() const { return data_->statistics; }
const Camera& Scene::camera() const { return data_->camera; }
void Scene::set_camera(const Camera& camera) { data_->camera = camera; }

}  // namespace fathom
