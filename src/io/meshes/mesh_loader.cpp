#include "collision_pairs/mesh_loader.h"

#include <cctype>
#include <filesystem>
#include <map>
#include <new>
#include <tuple>
#include <vector>

#include <rospack/rospack.h>

#include "collision_pairs/input_error.h"
#include "mesh_files.h"
#include "mesh_process.h"
#include "text_files.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& uri, const std::string& why) {
  throw InputError("mesh '" + uri + "': " + why);
}

class Loader {
 public:
  explicit Loader(Warn warn) : warn_(std::move(warn)) {}

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
    if (uri.rfind(FILE, 0) == 0) return existing(uri.substr(FILE.size()));
    if (uri.find("://") == std::string::npos) {
      fail(uri,
           "it has no scheme, and the file that it may be relative to is not known here; write "
           "package://PACKAGE/PATH or file:///PATH, or give the URDF as a file");
    }
    if (uri.rfind(PACKAGE, 0) != 0) fail(uri, "only package:// and file:// are read");
    const std::size_t slash = uri.find('/', PACKAGE.size());
    if (slash == std::string::npos) fail(uri, "it names a package, but no file");
    const std::string package = uri.substr(PACKAGE.size(), slash - PACKAGE.size());
    const std::string folder = findPackage(package);
    if (folder.empty()) fail(uri, "package '" + package + "' is not on ROS_PACKAGE_PATH");
    return existing(fs::path(folder) / uri.substr(slash + 1));
  }

  /// The path as it is written, or, if there is no such file, with %20 and the like decoded, as
  /// resource_retriever does.
  static fs::path existing(const fs::path& written) {
    std::error_code error;
    const fs::path decoded = decode(written.string());
    return !fs::exists(written, error) && fs::exists(decoded, error) ? decoded : written;
  }

  static std::string decode(const std::string& text) {
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const bool is_coded = text[i] == '%' && i + 2 < text.size() &&
                            std::isxdigit(static_cast<unsigned char>(text[i + 1])) &&
                            std::isxdigit(static_cast<unsigned char>(text[i + 2]));
      decoded +=
          is_coded ? static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16)) : text[i];
      if (is_coded) i += 2;
    }
    return decoded;
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
    // rospack looks anew at all folders for a package that it does not know.
    const auto [known, is_new] = folders_.try_emplace(package);
    if (is_new && !rospack_->find(package, known->second)) known->second.clear();
    return known->second;
  }

  TriangleMesh read(const fs::path& path) {
    std::string ending = path.extension().string();
    for (char& letter : ending) letter = static_cast<char>(std::tolower(letter));
    requireKnown(ending);
    if (ending == ".stl") return readStl(readBinaryFile(path));
    if (ending == ".obj") return readObj(readBinaryFile(path));
    if (ending == ".ply") return readPly(readBinaryFile(path));
    const double metres = ending == ".dae" ? readColladaUnit(readBinaryFile(path)) : 1.0;
    TriangleMesh mesh = readMeshInProcess(path.string());
    if (metres != 1.0) toMetres(path, metres, mesh);
    return mesh;
  }

  /// Formats of which what is missing can be told. Of others assimp leaves parts out without a
  /// word; and what it does not know by its ending it takes by its content, without the checks
  /// here.
  static void requireKnown(const std::string& ending) {
    static const std::vector<std::string> KNOWN = {".dae", ".glb", ".gltf", ".obj", ".ply", ".stl"};
    if (contains(KNOWN, ending)) return;
    throw InputError((ending.empty() ? "its name has no ending" : "'" + ending + "' is not read") +
                     "; convert it to one of " + joined(KNOWN, " ") +
                     ", for example by `assimp export`");
  }

  /// COLLADA's unit, as rviz has it, which assimp and geometric_shapes leave out.
  void toMetres(const fs::path& path, double metres, TriangleMesh& mesh) {
    for (Eigen::Vector3d& vertex : mesh.vertices) vertex *= metres;
    if (!warn_) return;
    warn_("mesh '" + path.string() + "' is in units of " + formatted("%g m", metres) +
          " (COLLADA's <unit>), and drawn so by rviz; MoveIt takes its numbers for metres. Further "
          "ones are not named");
    warn_ = nullptr;
  }

  std::map<std::tuple<std::string, double, double, double>, std::shared_ptr<const TriangleMesh>>
      meshes_;
  Warn warn_;  ///< empty: nobody is to be told, or has been
  std::unique_ptr<rospack::Rospack> rospack_;
  std::map<std::string, std::string> folders_;  ///< by package; empty: there is none
};

}  // namespace

MeshLoader makeMeshLoader(const Warn& warn) {
  const auto loader = std::make_shared<Loader>(warn);
  return [loader](const std::string& uri, const Eigen::Vector3d& scale) {
    return (*loader)(uri, scale);
  };
}

MeshLoader relativeTo(const std::string& folder, const MeshLoader& load) {
  if (folder.empty()) return load;
  const fs::path from = fs::absolute(folder);
  return [from, load](const std::string& uri, const Eigen::Vector3d& scale) {
    const bool is_path = !uri.empty() && uri.find("://") == std::string::npos;
    return load(is_path ? "file://" + (from / uri).lexically_normal().string() : uri, scale);
  };
}

}  // namespace collision_pairs
