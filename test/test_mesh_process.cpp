// Meshes of all other formats: what the process that reads them may do, and what is made of its
// answer.
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "mesh_folder.h"
#include "mesh_process.h"
#include "refusal.h"

namespace collision_pairs::test_mesh_process {

using testing::AnyOf;
using testing::HasSubstr;

class MeshProcess : public MeshFolder {
 protected:
  std::string file(const std::string& name, const std::string& content) const {
    MeshFolder::file(name, content);
    return folder_ / name;
  }
  std::string refusalOf(const std::string& name, const std::string& content) const {
    return collision_pairs::refusal(
        [&] { readMeshInProcess(file(name, content), std::chrono::seconds(1)); });
  }
};

std::string ply(const std::string& vertices_and_faces) {
  return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" +
         vertices_and_faces;
}
const std::string THREE = "0 0 0\n1 0 0\n0 1 0\n";

TEST_F(MeshProcess, ReadsWhatIsSound) {
  const TriangleMesh mesh =
      readMeshInProcess(file("a.ply", ply("1 2 3\n4 5 6\n-7 8 9.5\n3 0 1 2\n")));
  const std::vector<Eigen::Vector3d> corners = {{1, 2, 3}, {4, 5, 6}, {-7, 8, 9.5}};
  EXPECT_EQ(mesh.vertices, corners);
  EXPECT_THAT(mesh.triangles, testing::ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2}));
}

// Each ended or blocked the process that read it, by assimp 5.2.
TEST_F(MeshProcess, WhatBreaksAssimpIsRefused) {
  const std::string whole = ply(THREE + "3 0 1 2\n");
  for (const std::string& broken :
       {ply(THREE), whole.substr(0, 60), whole.substr(0, 30), ply(THREE + "3 0 1 -1\n"),
        ply(THREE + "0\n"), ply(THREE + "3 0 1 999999\n")}) {
    const std::string message = refusalOf("x.ply", broken);
    EXPECT_NE(message, "accepted") << broken;
    if (message.find("crashed") == std::string::npos) continue;
    EXPECT_THAT(message, AnyOf(HasSubstr("(Aborted)"), HasSubstr("(Segmentation fault)")));
  }
  const auto collada = [](const std::string& count, const std::string& indices) {
    return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
           "version='1.4.1'><library_geometries><geometry id='g'><mesh><source id='p'>"
           "<float_array id='a' count='" +
           count +
           "'>0 0 0 1 0 0 0 0 3</float_array><technique_common><accessor source='#a' count='3' "
           "stride='3'><param name='X' type='float'/><param name='Y' type='float'/><param name='Z' "
           "type='float'/></accessor></technique_common></source><vertices id='v'><input "
           "semantic='POSITION' source='#p'/></vertices><triangles count='1'><input "
           "semantic='VERTEX' source='#v' offset='0'/><p>" +
           indices +
           "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
           "<visual_scene id='s'><node id='n'><instance_geometry url='#g'/></node></visual_scene>"
           "</library_visual_scenes><scene><instance_visual_scene url='#s'/></scene></COLLADA>";
  };
  EXPECT_NO_THROW(readMeshInProcess(file("sound.dae", collada("9", "0 1 2"))));
  EXPECT_NE(refusalOf("x.dae", collada("s", "0 1 2")), "accepted");
  EXPECT_NE(refusalOf("x.dae", collada("9", "0 1 2.0")), "accepted");
  EXPECT_NE(refusalOf("x.dae", collada("9", "0 1 7")), "accepted");
}

TEST_F(MeshProcess, AFileThatClaimsMoreThanItsMemoryIsRefusedForThat) {
  const std::string many = "OFF\n2000000000 1 0\n0 0 0\n";
  EXPECT_EQ(refusalOf("x.off", many), "it needs more than 4 GiB of memory");
  const std::string vertices = ply("").replace(ply("").find("vertex 3"), 8, "vertex 4000000000");
  EXPECT_EQ(refusalOf("x.ply", vertices + THREE), "it needs more than 4 GiB of memory");
}

/// The process that this one has started, or "".
std::string child() {
  std::ifstream children("/proc/self/task/" + std::to_string(::getpid()) + "/children");
  EXPECT_TRUE(children);
  std::string pid;
  children >> pid;
  return pid;
}

/// A file that nobody else can open for 45 s (/proc/sys/fs/lease-break-time): what reads it as a
/// mesh is still there to be looked at. Assimp 5.4 refuses pipes.
class ShutFile {
 public:
  explicit ShutFile(const fs::path& folder)
      : path_(folder / "shut.ply"),
        descriptor_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    ::signal(SIGIO, SIG_IGN);  // comes when somebody waits for it
    EXPECT_EQ(::fcntl(descriptor_, F_SETLEASE, F_WRLCK), 0);
  }
  ~ShutFile() { ::close(descriptor_); }
  ShutFile(const ShutFile&) = delete;
  ShutFile& operator=(const ShutFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int descriptor_;
};

TEST_F(MeshProcess, LeavesNoProcessBehind) {
  const ShutFile mesh(folder_);
  EXPECT_THAT(
      collision_pairs::refusal([&] { readMeshInProcess(mesh.path(), std::chrono::seconds(1)); }),
      HasSubstr("did not finish within"));
  EXPECT_EQ(child(), "");
}

TEST_F(MeshProcess, AnAnswerLongerThanItsLimitIsRefusedAndTheProcessEnded) {
  const std::string whole = file("a.ply", ply(THREE + "3 0 1 2\n"));
  const std::size_t bytes = 1 + 2 * 8 + 3 * 3 * 4 + 3 * 4;
  EXPECT_NO_THROW(readMeshInProcess(whole, std::chrono::seconds(30), bytes));
  EXPECT_THAT(collision_pairs::refusal(
                  [&] { readMeshInProcess(whole, std::chrono::seconds(30), bytes - 1); }),
              HasSubstr("more than 64 bytes"));
  EXPECT_EQ(child(), "");
}

std::ptrdiff_t nbOpenFilesOf(const std::string& process) {
  std::error_code ended;
  return std::distance(fs::directory_iterator("/proc/" + process + "/fd", ended), {});
}

bool hasOpen(const std::string& process, const std::string& path) {
  std::error_code ended;
  for (const auto& entry : fs::directory_iterator("/proc/" + process + "/fd", ended)) {
    if (fs::read_symlink(entry, ended) == path) return true;
  }
  return false;
}

TEST_F(MeshProcess, LeavesNoFileOpen) {
  const auto before = nbOpenFilesOf("self");
  readMeshInProcess(file("a.ply", ply(THREE + "3 0 1 2\n")));
  EXPECT_EQ(nbOpenFilesOf("self"), before);
  EXPECT_NE(refusalOf("x.ply", ply(THREE).substr(0, 60)), "accepted");
  EXPECT_EQ(nbOpenFilesOf("self"), before);
}

/// `of` its lines in /proc/PID: "Max open files 64 64 files" with one blank for several.
std::string limit(const std::string& lines, const std::string& of) {
  const std::size_t at = lines.find(of);
  std::istringstream words(lines.substr(std::min(at, lines.size())));
  std::string line, text;
  std::getline(words, line);
  std::istringstream split(line);
  for (std::string word; split >> word;) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string contentOf(const std::string& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST_F(MeshProcess, MayGainNoRightsStartNoProcessAndWriteNoFile) {
  const ShutFile mesh(folder_);
  const std::string inherited = file("inherited", "");
  const int descriptor = ::open(inherited.c_str(), O_RDONLY);
  ASSERT_GT(descriptor, STDERR_FILENO);
  ASSERT_TRUE(hasOpen("self", inherited));
  bool has_inherited = true;
  std::string status, limits;
  std::thread look([&] {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(4);
    while ((limit(limits, "Max file size") != "Max file size 0 0 bytes" || has_inherited) &&
           std::chrono::steady_clock::now() < end) {
      const std::string process = "/proc/" + child();
      limits = contentOf(process + "/limits");
      status = contentOf(process + "/status");
      has_inherited = hasOpen(child(), inherited);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  EXPECT_NE(
      collision_pairs::refusal([&] { readMeshInProcess(mesh.path(), std::chrono::seconds(5)); }),
      "accepted");
  look.join();
  ::close(descriptor);
  EXPECT_FALSE(has_inherited);
  EXPECT_EQ(limit(status, "NoNewPrivs"), "NoNewPrivs: 1");
  EXPECT_EQ(limit(limits, "Max processes"), "Max processes 0 0 processes");
  EXPECT_EQ(limit(limits, "Max open files"), "Max open files 64 64 files");
  EXPECT_EQ(limit(limits, "Max file size"), "Max file size 0 0 bytes");
  EXPECT_EQ(limit(limits, "Max core file size"), "Max core file size 0 0 bytes");
  EXPECT_EQ(limit(limits, "Max cpu time"), "Max cpu time 60 60 seconds");
  EXPECT_EQ(limit(limits, "Max address space"), "Max address space 4294967296 4294967296 bytes");
}

TEST_F(MeshProcess, EndsWithTheProgramThatStartedIt) {
  const ShutFile mesh(folder_);
  ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // then its reader becomes a child of this
  const pid_t program = ::fork();
  if (program == 0) {
    collision_pairs::refusal([&] { readMeshInProcess(mesh.path(), std::chrono::seconds(20)); });
    ::_exit(0);
  }
  const std::string children =
      "/proc/" + std::to_string(program) + "/task/" + std::to_string(program) + "/children";
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  const auto isInTime = [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return std::chrono::steady_clock::now() < end;
  };
  pid_t reader = 0;
  const auto isSet = [&] {
    std::istringstream(contentOf(children)) >> reader;
    const std::string limits = contentOf("/proc/" + std::to_string(reader) + "/limits");
    return reader > 0 && limit(limits, "Max file size") == "Max file size 0 0 bytes";
  };
  while (!isSet() && isInTime()) {
  }
  ASSERT_GT(reader, 0);
  ::kill(program, SIGKILL);
  ::waitpid(program, nullptr, 0);
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(reader, &status, WNOHANG)) == 0 && isInTime()) {
  }
  if (ended == 0) ::kill(reader, SIGKILL);
  EXPECT_EQ(ended, reader);
  EXPECT_TRUE(WIFSIGNALED(status));
}

}  // namespace collision_pairs::test_mesh_process
