#include "mesh_loader.h"

#include <filesystem>
#include <map>
#include <tuple>

#include <geometric_shapes/mesh_operations.h>
#include <rospack/rospack.h>

#include "collision_pairs/input_error.h"
#include "console_messages.h"

namespace collision_pairs {
namespace {

namespace fs = std::filesystem;

bool startsWith(const std::string& text, const std::string& beginning) {
  return text.compare(0, beginning.size(), beginning) == 0;
}

[[noreturn]] void fail(const std::string& uri, const std::string& why) {
  throw InputError("mesh '" + uri + "': " + why);
}

class Loader {
 public:
  std::shared_ptr<const TriangleMesh> operator()(const std::string& uri,
                                                 const Eigen::Vector3d& scale) {
    auto& known = meshes_[std::make_tuple(uri, scale.x(), scale.y(), scale.z())];
    if (!known) known = load(uri, scale);
    return known;
  }

 private:
  std::shared_ptr<const TriangleMesh> load(const std::string& uri, const Eigen::Vector3d& scale) {
    const fs::path path = fs::absolute(resolve(uri));
    std::error_code error;
    if (!fs::exists(path, error)) fail(uri, "there is no file " + path.string());
    if (!fs::is_regular_file(path, error)) fail(uri, path.string() + " is not a file");
    if (fs::file_size(path, error) == 0) fail(uri, "the file is empty");
    return convert(uri, read(uri, path), scale);
  }

  fs::path resolve(const std::string& uri) {
    static const std::string PACKAGE = "package://", FILE = "file://";
    if (startsWith(uri, FILE)) return uri.substr(FILE.size());
    if (!startsWith(uri, PACKAGE)) fail(uri, "only package:// and file:// are read");
    const std::size_t slash = uri.find('/', PACKAGE.size());
    if (slash == std::string::npos) fail(uri, "it names a package but no file");
    const std::string package = uri.substr(PACKAGE.size(), slash - PACKAGE.size());
    const std::string folder = findPackage(package);
    if (folder.empty()) fail(uri, "package '" + package + "' is not on ROS_PACKAGE_PATH");
    return fs::path(folder) / uri.substr(slash + 1);
  }

  // rospack itself, and not ros::package::getPath, which prints two lines about what it misses.
  std::string findPackage(const std::string& package) {
    if (!rospack_) {
      rospack_ = std::make_unique<rospack::Rospack>();
      rospack_->setQuiet(true);
      std::vector<std::string> folders;
      rospack_->getSearchPathFromEnv(folders);
      rospack_->crawl(folders, false);
    }
    std::string folder;
    return rospack_->find(package, folder) ? folder : "";
  }

  static std::unique_ptr<shapes::Mesh> read(const std::string& uri, const fs::path& path) {
    ConsoleMessages messages;
    std::unique_ptr<shapes::Mesh> mesh;
    try {
      mesh.reset(shapes::createMeshFromResource("file://" + path.string()));
    } catch (const std::exception& error) {
      fail(uri, error.what());
    }
    if (!mesh) {
      fail(uri, messages.firstError().empty() ? "it is not a mesh that can be read (truncated?)"
                                              : messages.firstError());
    }
    return mesh;
  }

  static std::shared_ptr<const TriangleMesh> convert(const std::string& uri,
                                                     std::unique_ptr<shapes::Mesh> source,
                                                     const Eigen::Vector3d& scale) {
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->name = uri;
    for (unsigned i = 0; i < source->vertex_count; ++i) {
      mesh->vertices.push_back(
          Eigen::Map<Eigen::Vector3d>(source->vertices + 3 * i).cwiseProduct(scale));
    }
    for (unsigned i = 0; i < source->triangle_count; ++i) {
      const unsigned* t = source->triangles + 3 * i;
      mesh->triangles.push_back({t[0], t[1], t[2]});
    }
    return mesh;
  }

  std::map<std::tuple<std::string, double, double, double>, std::shared_ptr<const TriangleMesh>>
      meshes_;
  std::unique_ptr<rospack::Rospack> rospack_;
};

}  // namespace

MeshLoader makeMeshLoader() {
  const auto loader = std::make_shared<Loader>();
  return [loader](const std::string& uri, const Eigen::Vector3d& scale) {
    return (*loader)(uri, scale);
  };
}

}  // namespace collision_pairs
