#include "collision_pairs/mesh_loader.h"

#include <cctype>
#include <filesystem>
#include <map>
#include <new>
#include <tuple>

#include <rospack/rospack.h>

#include "collision_pairs/input_error.h"
#include "mesh_files.h"
#include "mesh_process.h"
#include "text_files.h"

namespace collision_pairs {
namespace {

namespace fs = std::filesystem;

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
    auto mesh = std::make_shared<TriangleMesh>();
    try {
      *mesh = read(path);
    } catch (const std::bad_alloc&) {
      fail(uri, "not enough memory to read it");
    } catch (const std::exception& problem) {
      fail(uri, problem.what());
    }
    mesh->name = uri;
    for (Eigen::Vector3d& vertex : mesh->vertices) vertex = vertex.cwiseProduct(scale);
    return mesh;
  }

  fs::path resolve(const std::string& uri) {
    static const std::string PACKAGE = "package://", FILE = "file://";
    if (uri.rfind(FILE, 0) == 0) return uri.substr(FILE.size());
    if (uri.rfind(PACKAGE, 0) != 0) fail(uri, "only package:// and file:// are read");
    const std::size_t slash = uri.find('/', PACKAGE.size());
    if (slash == std::string::npos) fail(uri, "it names a package, but no file");
    const std::string package = uri.substr(PACKAGE.size(), slash - PACKAGE.size());
    const std::string folder = findPackage(package);
    if (folder.empty()) fail(uri, "package '" + package + "' is not on ROS_PACKAGE_PATH");
    return fs::path(folder) / uri.substr(slash + 1);
  }

  // Uses rospack directly, because ros::package::getPath prints two lines if a package is missing.
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

  static TriangleMesh read(const fs::path& path) {
    std::string ending = path.extension().string();
    for (char& letter : ending) letter = static_cast<char>(std::tolower(letter));
    if (ending == ".stl") return readStl(readBinaryFile(path));
    std::optional<TriangleMesh> mesh;
    if (ending == ".obj") mesh = readObj(readBinaryFile(path));
    return mesh ? std::move(*mesh) : readMeshInProcess(path.string());
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
