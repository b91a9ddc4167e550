// A folder for the meshes of one test, and what is said of them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "collision_pairs/mesh_loader.h"

namespace collision_pairs {

namespace fs = std::filesystem;

inline const Eigen::Vector3d ONE = Eigen::Vector3d::Ones();

class MeshFolder : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return "file://" + (folder_ / name).string();
  }
  std::string refusal(const std::string& uri) {
    try {
      validateShape(Mesh{load_(uri, ONE)});
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path folder_ = fs::temp_directory_path() / ("mesh_folder_" + std::to_string(::getpid()));
  MeshLoader load_ = makeMeshLoader();
};

/// Of the corners of each triangle, behind a header that may begin with some words.
inline std::string binaryStl(const std::vector<std::array<float, 9>>& triangles,
                             std::string stl = "") {
  stl.resize(80, ' ');
  const auto append = [&](const auto& value) {
    stl.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(static_cast<std::uint32_t>(triangles.size()));
  for (const auto& corners : triangles) {
    for (int i = 0; i < 3; ++i) append(0.0f);
    for (const float c : corners) append(c);
    append(static_cast<std::uint16_t>(0));
  }
  return stl;
}

/// A triangle with the corners 0, (1, 0, 0) and (0, 0, 3). `asset`: what <asset> holds.
inline std::string collada(const std::string& asset) {
  return "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
         "version='1.4.1'><asset>" +
         asset +
         "</asset><library_geometries>"
         "<geometry id='g'><mesh><source id='p'><float_array id='a' count='9'>0 0 0 1 0 0 0 0 3"
         "</float_array><technique_common><accessor source='#a' count='3' stride='3'>"
         "<param name='X' type='float'/><param name='Y' type='float'/><param name='Z' "
         "type='float'/></accessor></technique_common></source><vertices id='v'><input "
         "semantic='POSITION' source='#p'/></vertices><triangles count='1'><input "
         "semantic='VERTEX' source='#v' offset='0'/><p>0 1 2</p></triangles></mesh></geometry>"
         "</library_geometries><library_visual_scenes><visual_scene id='s'><node id='n'>"
         "<instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url='#s'/></scene></COLLADA>";
}

inline Eigen::Vector3d mostOf(const TriangleMesh& mesh) {
  Eigen::Vector3d most = mesh.vertices.front();
  for (const Eigen::Vector3d& vertex : mesh.vertices) most = most.cwiseMax(vertex);
  return most;
}

/// `text` with `what` before the first `place`.
inline std::string before(const std::string& place, const std::string& what, std::string text) {
  return text.insert(text.find(place), what);
}

}  // namespace collision_pairs
