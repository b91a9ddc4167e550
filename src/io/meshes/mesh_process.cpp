#include "mesh_process.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "collision_pairs/input_error.h"

extern char** environ;

namespace collision_pairs {
namespace {

using Clock = std::chrono::steady_clock;

const char* const NOT_READ = "assimp, which reads this format, ";

/// By its place beside this library, installed or not: lib/collision_pairs/read_mesh_file beside
/// lib/libcollision_pairs_io.so, or lib/ARCHITECTURE/libcollision_pairs_io.so in Debian's /usr.
std::string programPath() {
  Dl_info library{};
  if (::dladdr(reinterpret_cast<const void*>(&programPath), &library) == 0) return "";
  const std::string path = library.dli_fname;
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash);
  return folder + "/" PROGRAMS_FROM_LIBRARIES "/read_mesh_file";
}

/// A running read_mesh_file, killed by the destructor.
class Child {
 public:
  explicit Child(const std::string& path) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) failToStart(errno);
    output_ = ends[0];
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    const std::string program = programPath();
    const char* arguments[] = {program.c_str(), path.c_str(), nullptr};
    const int error = ::posix_spawn(&pid_, program.c_str(), &actions, nullptr,
                                    const_cast<char**>(arguments), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (error != 0) {
      ::close(output_);
      failToStart(error);
    }
  }
  ~Child() {
    ::close(output_);
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      waitForEnd();
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Its complete output.
  std::string readAll(std::chrono::milliseconds time_limit, std::size_t most_bytes) {
    const auto deadline = Clock::now() + time_limit;
    std::string all;
    constexpr std::size_t STEP = 1 << 18;
    std::string step(STEP, '\0');
    while (true) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
      pollfd waited{output_, POLLIN, 0};
      if (left.count() <= 0) {
        throw InputError(NOT_READ + std::string("did not finish within ") +
                         std::to_string(time_limit.count()) + " ms");
      }
      const int ready = ::poll(&waited, 1, static_cast<int>(left.count()));
      if (ready < 0 && errno != EINTR) throw InputError(std::strerror(errno));
      if (ready <= 0) continue;
      const ssize_t count = ::read(output_, step.data(), step.size());
      if (count < 0 && errno != EINTR) throw InputError(std::strerror(errno));
      if (count == 0) return all;
      if (count > 0) all.append(step, 0, static_cast<std::size_t>(count));
      if (all.size() > most_bytes) {
        throw InputError(NOT_READ + std::string("made a mesh of more than ") +
                         std::to_string(most_bytes) + " bytes of it");
      }
    }
  }

  /// Its status from waitpid().
  int waitForEnd() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  [[noreturn]] static void failToStart(int error) {
    throw InputError("read_mesh_file, which reads this format, could not be started: " +
                     std::string(std::strerror(error)));
  }
  pid_t pid_ = -1;
  int output_ = -1;
};

/// Extracts numbers from the front of the data read.
class Cut {
 public:
  Cut(const char* at, std::size_t left) : at_(at), left_(left) {}
  template <class Number>
  bool take(std::size_t count, Number* numbers) {
    if (count > left_ / sizeof(Number)) return false;
    std::memcpy(numbers, at_, count * sizeof(Number));
    at_ += count * sizeof(Number);
    left_ -= count * sizeof(Number);
    return true;
  }
  std::size_t left() const { return left_; }

 private:
  const char* at_;
  std::size_t left_;
};

bool unpack(const std::string& answer, TriangleMesh& mesh) {
  Cut cut(answer.data() + 1, answer.size() - 1);
  std::uint64_t nb_vertices = 0, nb_triangles = 0;
  if (!cut.take(1, &nb_vertices) || !cut.take(1, &nb_triangles)) return false;
  if (nb_vertices > cut.left() || nb_triangles > cut.left()) return false;
  std::array<float, 3> corner;
  for (std::uint64_t i = 0; i < nb_vertices; ++i) {
    if (!cut.take(3, corner.data())) return false;
    mesh.vertices.emplace_back(corner[0], corner[1], corner[2]);
  }
  mesh.triangles.resize(nb_triangles);
  for (auto& triangle : mesh.triangles) {
    if (!cut.take(3, triangle.data())) return false;
  }
  return cut.left() == 0;
}

}  // namespace

TriangleMesh readMeshInProcess(const std::string& path, std::chrono::milliseconds time_limit,
                               std::size_t most_bytes) {
  Child child(path);
  const std::string answer = child.readAll(time_limit, most_bytes);
  const int status = child.waitForEnd();
  if (WIFSIGNALED(status)) {
    throw InputError(NOT_READ + std::string("crashed on it (") + ::strsignal(WTERMSIG(status)) +
                     ")");
  }
  TriangleMesh mesh;
  if (!answer.empty() && answer[0] == mesh_pipe::MESH && unpack(answer, mesh)) return mesh;
  if (!answer.empty() && answer[0] == mesh_pipe::REFUSED) throw InputError(answer.substr(1));
  throw InputError(NOT_READ + std::string("ended without an answer, status ") +
                   std::to_string(WEXITSTATUS(status)));
}

}  // namespace collision_pairs
