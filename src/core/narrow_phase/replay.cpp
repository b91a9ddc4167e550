#include "replay.h"

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace collision_pairs {
namespace {

std::string hex(double value) {
  char text[40];
  std::snprintf(text, sizeof text, " %a", value);
  return text;
}

std::string hex(const Eigen::Vector3d& v) { return hex(v[0]) + hex(v[1]) + hex(v[2]); }

std::string triangles(const TriangleMesh& mesh) {
  std::string text = " " + std::to_string(mesh.vertices.size()) + " " +
                     std::to_string(mesh.triangles.size()) + "\n";
  for (const Eigen::Vector3d& v : mesh.vertices) text += hex(v) + "\n";
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t i : t) text += " " + std::to_string(i);
    text += "\n";
  }
  return text;
}

struct Writer {
  std::string operator()(const Box& box) const { return hex(box.size) + "\n"; }
  std::string operator()(const Sphere& sphere) const { return hex(sphere.radius) + "\n"; }
  std::string operator()(const Cylinder& c) const { return hex(c.radius) + hex(c.length) + "\n"; }
  std::string operator()(const Capsule& c) const { return hex(c.radius) + hex(c.length) + "\n"; }
  std::string operator()(const HalfSpace&) const { return "\n"; }
  std::string operator()(const Convex& convex) const { return triangles(*convex.mesh); }
  std::string operator()(const Mesh& mesh) const { return triangles(*mesh.mesh); }
};

class Reader {
 public:
  explicit Reader(std::istream& in) : in_(in) {}

  std::string word(const char* what) {
    std::string text;
    if (!(in_ >> text)) throw std::runtime_error(std::string("replay ends before ") + what);
    return text;
  }
  void expect(const std::string& wanted) {
    const std::string found = word(wanted.c_str());
    if (found != wanted) {
      throw std::runtime_error("replay: expected '" + wanted + "', found '" + found + "'");
    }
  }
  double number() {
    const std::string text = word("a number");
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end != '\0') throw std::runtime_error("replay: '" + text + "' is not a number");
    return value;
  }
  std::uint32_t index() {
    const double value = number();
    if (!(value >= 0.0 && value < 4294967296.0)) {
      throw std::runtime_error("replay: " + std::to_string(value) + " is no index");
    }
    return static_cast<std::uint32_t>(value);
  }
  Eigen::Vector3d vector() {
    Eigen::Vector3d v;
    for (int i = 0; i < 3; ++i) v[i] = number();
    return v;
  }
  std::shared_ptr<const TriangleMesh> mesh() {
    auto mesh = std::make_shared<TriangleMesh>();
    const std::uint32_t num_vertices = index(), num_triangles = index();
    for (std::uint32_t i = 0; i < num_vertices; ++i) mesh->vertices.push_back(vector());
    for (std::uint32_t i = 0; i < num_triangles; ++i) {
      const std::uint32_t a = index(), b = index(), c = index();
      mesh->triangles.push_back({a, b, c});
    }
    return mesh;
  }
  Shape shape() {
    const std::string kind = word("a shape");
    if (kind == "box") return Box{vector()};
    if (kind == "sphere") return Sphere{number()};
    if (kind == "half-space") return HalfSpace{};
    if (kind == "convex") return Convex{mesh()};
    if (kind == "mesh") return Mesh{mesh()};
    if (kind != "cylinder" && kind != "capsule") {
      throw std::runtime_error("replay: unknown shape '" + kind + "'");
    }
    const double radius = number(), length = number();
    if (kind == "cylinder") return Cylinder{radius, length};
    return Capsule{radius, length};
  }

 private:
  std::istream& in_;
};

}  // namespace

std::string writeReplay(const Replay& replay) {
  std::string text = "collision_pairs_replay 1\n";
  for (const Shape* shape : {&replay.A, &replay.B}) {
    text += std::string(shapeName(*shape)) + std::visit(Writer{}, *shape);
  }
  text += "pose\n";
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) text += hex(replay.X_AB(row, column));
    text += "\n";
  }
  return text + "max_distance" + hex(replay.max_distance) + "\nend\n";
}

Replay readReplay(std::istream& in) {
  Reader reader(in);
  reader.expect("collision_pairs_replay");
  reader.expect("1");
  Replay replay{reader.shape(), reader.shape(), Eigen::Isometry3d::Identity(), 0.0};
  reader.expect("pose");
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) replay.X_AB(row, column) = reader.number();
  }
  reader.expect("max_distance");
  replay.max_distance = reader.number();
  reader.expect("end");
  return replay;
}

}  // namespace collision_pairs
