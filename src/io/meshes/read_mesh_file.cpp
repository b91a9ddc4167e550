// read_mesh_file FILE: writes the mesh, or the reason why there is none, in the format of
// mesh_process.h.
#include <cctype>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <vector>

#include <console_bridge/console.h>
#include <geometric_shapes/mesh_operations.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

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

/// The first error of geometric_shapes, which reports to console_bridge only.
class FirstError : public console_bridge::OutputHandler {
 public:
  FirstError() { console_bridge::useOutputHandler(this); }
  ~FirstError() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& message, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && text.empty()) text = message;
  }
  std::string text;
};

void refuse(const std::string& why) { std::cout << REFUSED << why; }

template <class Number>
void write(const Number* numbers, std::size_t count) {
  std::cout.write(reinterpret_cast<const char*>(numbers),
                  static_cast<std::streamsize>(count * sizeof(Number)));
}

/// As a URI: resource_retriever takes it apart.
std::string uriOf(const std::string& path) {
  std::string uri = "file://";
  for (const unsigned char c : path) {
    const bool is_plain = std::isalnum(c) || std::strchr("/-_.~", c) != nullptr;
    char coded[4];
    std::snprintf(coded, sizeof coded, "%%%02X", static_cast<unsigned>(c));
    uri += is_plain ? std::string(1, static_cast<char>(c)) : coded;
  }
  return uri;
}

/// What geometric_shapes says may end where curl's reason would stand.
bool saysWhy(const std::string& text) {
  const std::size_t last = text.find_last_not_of(" \n");
  return last != std::string::npos && text[last] != ':';
}

void answer(const std::string& path) {
  FirstError error;
  const std::unique_ptr<shapes::Mesh> mesh(shapes::createMeshFromResource(uriOf(path)));
  if (memory_ran_out) throw std::bad_alloc();
  if (!mesh) {
    return refuse(saysWhy(error.text) ? error.text
                                      : "it is not a mesh that can be read (truncated?)");
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
