// read_mesh_file FILE: writes the mesh, or the reason why there is none, in the format of
// mesh_process.h.
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <console_bridge/console.h>
#include <geometric_shapes/mesh_operations.h>
#include <strings.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "gltf_triangles.h"
#include "mesh_process.h"

namespace {

using collision_pairs::mesh_pipe::MESH;
using collision_pairs::mesh_pipe::REFUSED;

constexpr rlim_t MEMORY_LIMIT = rlim_t{4} << 30;  // bytes
constexpr rlim_t TIME_LIMIT = 60;                 // s: the parent waits half of that

constexpr rlim_t OPEN_FILES = 64;  // a mesh may be in several

template <class Resource>
void limitTo(rlim_t most, Resource resource) {
  const rlimit limit{most, most};
  ::setrlimit(resource, &limit);
}

// What a file can make assimp do ends with this process. Root may start processes all the same.
void limitItself() {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  limitTo(MEMORY_LIMIT, RLIMIT_AS);
  limitTo(TIME_LIMIT, RLIMIT_CPU);
  limitTo(OPEN_FILES, RLIMIT_NOFILE);
  limitTo(0, RLIMIT_CORE);
  limitTo(0, RLIMIT_NPROC);
  limitTo(0, RLIMIT_FSIZE);  // of files, not of pipes
}

// Closes the parent's sockets: otherwise they would stay open while this process lives, even if the
// parent closes them.
void closeInherited() {
  std::vector<int> inherited;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    inherited.push_back(std::stoi(entry.path().filename()));
  }
  for (const int descriptor : inherited) {
    if (descriptor > STDERR_FILENO) ::close(descriptor);
  }
}

bool memory_ran_out = false;  // assimp does not pass bad_alloc on

void watchMemory() {
  std::set_new_handler([] {
    memory_ran_out = true;
    throw std::bad_alloc();
  });
}

/// geometric_shapes reports to console_bridge, which prints.
class Silence : public console_bridge::OutputHandler {
 public:
  Silence() { console_bridge::useOutputHandler(this); }
  ~Silence() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string&, console_bridge::LogLevel, const char*, int) override {}
};

void refuse(const std::string& why) { std::cout << REFUSED << why; }

template <class Number>
void write(const Number* numbers, std::size_t count) {
  std::cout.write(reinterpret_cast<const char*>(numbers),
                  static_cast<std::streamsize>(count * sizeof(Number)));
}

/// As rviz has it: a mesh of the root node is placed by the root's transform, all others by those
/// of the nodes below it, since assimp expresses up_axis in the root. (geometric_shapes clears
/// that.)
void clearRootAsRvizDoes(aiScene& scene) {
  aiNode& root = *scene.mRootNode;
  if (root.mNumMeshes > 0) {
    auto own = std::make_unique<aiNode>();
    own->mTransformation = root.mTransformation;
    std::swap(own->mNumMeshes, root.mNumMeshes);
    std::swap(own->mMeshes, root.mMeshes);
    aiNode* added = own.release();
    root.addChildren(1, &added);
  }
  root.mTransformation = aiMatrix4x4();
}

/// As in a URDF, a scale of 0 makes a sheet or a speck of a body.
void refuseFlattened(const aiNode& node, const aiMatrix4x4& X_WP) {
  constexpr float FLAT = 1e-6f;  // the volume of a unit cube there, by that of its edges
  const aiMatrix4x4 X_WN = X_WP * node.mTransformation;
  const float edges = aiVector3D(X_WN.a1, X_WN.b1, X_WN.c1).Length() *
                      aiVector3D(X_WN.a2, X_WN.b2, X_WN.c2).Length() *
                      aiVector3D(X_WN.a3, X_WN.b3, X_WN.c3).Length();
  const float volume = std::abs(aiMatrix3x3(X_WN).Determinant());
  if (node.mNumMeshes > 0 && !(volume > FLAT * edges)) {
    throw std::runtime_error("its node '" + std::string(node.mName.C_Str()) +
                             "' flattens what it places: a scale of 0?");
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) refuseFlattened(*node.mChildren[i], X_WN);
}

/// Positions and triangles of the file, read as geometric_shapes reads them from memory. By its
/// path, since glTF may keep its numbers in a file beside it.
std::unique_ptr<shapes::Mesh> read(const std::string& path, Assimp::Importer& importer) {
  constexpr int NOT_USED = aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                           aiComponent_COLORS | aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS |
                           aiComponent_ANIMATIONS | aiComponent_TEXTURES | aiComponent_LIGHTS |
                           aiComponent_CAMERAS | aiComponent_MATERIALS;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, NOT_USED);
  // Else it makes a mesh of the nodes where there is no surface.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene =
      importer.ReadFile(path, aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                  aiProcess_SortByPType | aiProcess_RemoveComponent);
  if (!scene || !scene->mRootNode) return nullptr;
  if (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) {
    throw std::runtime_error("it has no surface, or assimp does not read all of it");
  }
  clearRootAsRvizDoes(const_cast<aiScene&>(*scene));  // the importer's
  refuseFlattened(*scene->mRootNode, aiMatrix4x4());
  scene = importer.ApplyPostProcessing(aiProcess_OptimizeMeshes | aiProcess_OptimizeGraph);
  if (!scene) return nullptr;
  return std::unique_ptr<shapes::Mesh>(shapes::createMeshFromAsset(scene));
}

void answer(const std::string& path) {
  const Silence silence;
  const std::string ending = std::filesystem::path(path).extension();
  const bool is_gltf = ::strncasecmp(ending.c_str(), ".gl", 3) == 0;  // .gltf, .glb
  const std::size_t nb_triangles = is_gltf ? nbTrianglesOfGltf(path) : 0;
  Assimp::Importer importer;
  const std::unique_ptr<shapes::Mesh> mesh = read(path, importer);
  if (memory_ran_out) throw std::bad_alloc();
  if (!mesh) {
    const std::string why = importer.GetErrorString();
    return refuse(why.empty() ? "it is not a mesh that can be read (truncated?)" : why);
  }
  if (is_gltf && mesh->triangle_count != nb_triangles) {
    return refuse("it places " + std::to_string(nb_triangles) +
                  " triangles, of which assimp reads " + std::to_string(mesh->triangle_count));
  }
  const std::uint64_t counts[] = {mesh->vertex_count, mesh->triangle_count};
  std::cout << MESH;
  write(counts, 2);
  for (std::size_t i = 0; i < 3 * counts[0]; ++i) {
    const auto coordinate = static_cast<float>(mesh->vertices[i]);
    write(&coordinate, 1);
  }
  write(mesh->triangles, 3 * counts[1]);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  limitItself();
  closeInherited();
  watchMemory();
  try {
    answer(argv[1]);
  } catch (const std::bad_alloc&) {
    refuse("it needs more than " + std::to_string(MEMORY_LIMIT >> 30) + " GiB of memory");
  } catch (const std::exception& error) {
    refuse(error.what());
  }
  std::cout.flush();
  return 0;
}
