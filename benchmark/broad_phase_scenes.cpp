#include "broad_phase_scenes.h"

#include <cmath>
#include <random>
#include <stdexcept>

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

class Maker {
 public:
  explicit Maker(std::size_t nb_boxes) : n_(static_cast<double>(nb_boxes)), count_(nb_boxes) {}

  // Cubes with lower corners in a unit cube: two of side s overlap with probability (2 s)^3.
  std::vector<Aabb> uniform(double overlaps) {
    const double side = 0.5 * std::cbrt(overlaps / n_);
    return make([&] { return Vector3d(uni(), uni(), uni()); }, Vector3d::Constant(side));
  }
  std::vector<Aabb> line() {
    const double side = 1.0 / n_;
    return make([&] { return Vector3d(uni(), 0.5 * side * uni(), 0.5 * side * uni()); },
                Vector3d::Constant(side));
  }
  std::vector<Aabb> clusters() {
    constexpr int NB_CLUSTERS = 20;
    std::vector<Vector3d> corners;
    for (int i = 0; i < NB_CLUSTERS; ++i) corners.push_back(50.0 * Vector3d(uni(), uni(), uni()));
    const double side = 0.5 * std::cbrt(2.0 * NB_CLUSTERS / n_);
    std::size_t next = 0;
    return make(
        [&]() -> Vector3d { return corners[next++ % NB_CLUSTERS] + Vector3d(uni(), uni(), uni()); },
        Vector3d::Constant(side));
  }
  std::vector<Aabb> plane() {
    const double side = 0.5 * std::sqrt(2.0 / n_);
    return make([&] { return Vector3d(uni(), uni(), 0.2 * side * uni()); },
                Vector3d::Constant(side));
  }
  std::vector<Aabb> rods() {
    const double side = 0.5 * std::sqrt(2.0 / n_);
    return make([&] { return Vector3d(2.0 * uni(), uni(), uni()); }, Vector3d(2.0, side, side));
  }
  // Sides s u with log u even over three decades. The mean of (u + v)^3 over two boxes is 0.181.
  std::vector<Aabb> mixed() {
    const double largest = std::cbrt(2.0 / n_ / 0.181);
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < count_; ++i) {
      const Vector3d corner(uni(), uni(), uni());
      boxes.push_back(
          {corner, corner + Vector3d::Constant(largest * std::pow(10.0, -3.0 * uni()))});
    }
    return boxes;
  }
  double uni() { return std::uniform_real_distribution<double>(0.0, 1.0)(engine_); }

 private:
  template <class Corner>
  std::vector<Aabb> make(Corner corner, const Vector3d& size) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < count_; ++i) {
      const Vector3d low = corner();
      boxes.push_back({low, low + size});
    }
    return boxes;
  }
  double n_;
  std::size_t count_;
  std::mt19937_64 engine_{20240611};
};

std::vector<Aabb> firstFrame(const std::string& name, Maker* maker) {
  if (name == "uniform2" || name == "static95") return maker->uniform(2.0);
  if (name == "uniform10") return maker->uniform(10.0);
  if (name == "line") return maker->line();
  if (name == "clusters") return maker->clusters();
  if (name == "plane") return maker->plane();
  if (name == "rods") return maker->rods();
  if (name == "mixed") return maker->mixed();
  throw std::invalid_argument("no scene is called " + name);
}

// So that the smallest side is 1 m in the mean: Bullet fattens boxes by 5 cm whatever their size.
std::vector<Aabb> scaledToMetres(std::vector<Aabb> boxes) {
  double mean = 0.0;
  for (const Aabb& box : boxes) {
    mean += (box.max - box.min).minCoeff() / static_cast<double>(boxes.size());
  }
  for (Aabb& box : boxes) {
    box.min /= mean;
    box.max /= mean;
  }
  return boxes;
}

}  // namespace

const std::vector<std::string>& sceneNames() {
  static const std::vector<std::string> NAMES = {"uniform2", "uniform10", "line",  "clusters",
                                                 "plane",    "rods",      "mixed", "static95"};
  return NAMES;
}

MovingScene makeScene(const std::string& name, std::size_t nb_boxes) {
  constexpr std::size_t NB_FRAMES = 4;
  Maker maker(nb_boxes);
  MovingScene scene;
  if (name == "static95") scene.nb_static = nb_boxes * 95 / 100;
  scene.frames.push_back(scaledToMetres(firstFrame(name, &maker)));
  while (scene.frames.size() < NB_FRAMES) {
    scene.frames.push_back(scene.frames.back());
    for (std::size_t i = scene.nb_static; i < nb_boxes; ++i) {
      Aabb& box = scene.frames.back()[i];
      const double step = 0.1 * (box.max - box.min).minCoeff();
      const Vector3d move =
          step * Vector3d(maker.uni() - 0.5, maker.uni() - 0.5, maker.uni() - 0.5);
      box.min += move;
      box.max += move;
    }
  }
  return scene;
}

}  // namespace collision_pairs
