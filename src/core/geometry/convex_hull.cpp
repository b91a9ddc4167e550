#include "convex_hull.h"

#include <algorithm>
#include <cstdio>
#include <set>

#ifdef COLLISION_PAIRS_QHULLCPP
#include <libqhullcpp/QhullQh.h>
#else
extern "C" {
#include <libqhull_r/qhull_ra.h>
}
#endif

namespace collision_pairs {
namespace {

// Up to about this many vertices, comparing all with SIMD is as fast as walking along edges.
constexpr std::size_t CLIMB_ABOVE = 48;

bool lexicographicallyLess(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

std::vector<Eigen::Vector3d> withoutDuplicates(std::vector<Eigen::Vector3d> points) {
  std::sort(points.begin(), points.end(), lexicographicallyLess);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

#ifdef COLLISION_PAIRS_QHULLCPP
using QhullState = orgQhull::QhullQh;
#else  // Ubuntu 20.04, whose libqhullcpp is static: no process can have loaded it
using QhullState = qhT;
#endif

// Owns Qhull's state; its messages are discarded.
//
// A process may have loaded libqhullcpp, whose qh_fprintf() then stands for that of libqhull_r and
// ends the process at the first message, unless the state is a QhullQh. So it is one. Its streams
// must be real ones all the same: libqhull_r's qh_fprintf() writes to what it is given.
class Qhull {
 public:
  Qhull() : silence_(std::fopen("/dev/null", "w")) {}
  ~Qhull() {
    if (silence_ == nullptr) return;
    free();
    std::fclose(silence_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  /// The steps of qh_new_qhull(), which would make the state that of C. Its last, which compares
  /// every point with every facet, it takes with option Tv only.
  bool run(std::vector<Eigen::Vector3d>& points) {
    if (silence_ == nullptr) return false;
    char command[] = "qhull Qt";
    qh_meminit(&state_, silence_);
    qh_initqhull_start(&state_, nullptr, nullptr, silence_);
    state_.ISqhullQh = True;
    const int status = setjmp(state_.errexit);
    if (status == 0) {
      state_.NOerrexit = False;
      qh_initflags(&state_, command);
      qh_init_B(&state_, points.front().data(), static_cast<int>(points.size()), 3, False);
      qh_qhull(&state_);
      qh_check_output(&state_);
      qh_prepare_output(&state_);
    }
    state_.NOerrexit = True;
    return status == 0;
  }
  qhT* state() { return &state_; }

 private:
  // What an error leaves unfreed would end the process in ~QhullQh(): it finds a new state.
  void free() {
    qh_freeqhull(&state_, !qh_ALL);
    int left = 0, total = 0;
    qh_memfreeshort(&state_, &left, &total);
    qh_meminit(&state_, silence_);
    qh_initqhull_start2(&state_, nullptr, nullptr, silence_);
  }

  QhullState state_{};
  std::FILE* silence_;
};

// Corners of the triangulated facets, as indices into the points Qhull was given.
std::vector<std::array<int, 3>> triangles(Qhull& qhull) {
  std::vector<std::array<int, 3>> result;
  qhT* qh = qhull.state();
  for (facetT* facet = qh->facet_list; facet != nullptr && facet->next != nullptr;
       facet = facet->next) {
    std::array<int, 3> corner{};
    int count = 0;
    for (int i = 0; i < qh_setsize(qh, facet->vertices); ++i) {
      const auto* vertex = static_cast<vertexT*>(facet->vertices->e[i].p);
      if (count < 3) corner[count] = qh_pointid(qh, vertex->point);
      ++count;
    }
    if (count == 3) result.push_back(corner);
  }
  return result;
}

// Volume of the convex solid that the triangles bound, whatever their orientation.
double volumeAround(const Eigen::Vector3d& center, const std::vector<Eigen::Vector3d>& points,
                    const std::vector<std::array<int, 3>>& faces) {
  double volume = 0.0;
  for (const auto& f : faces) {
    const Eigen::Vector3d a = points[f[0]] - center, b = points[f[1]] - center;
    volume += std::abs(a.cross(b).dot(points[f[2]] - center)) / 6.0;
  }
  return volume;
}

void buildEdges(const std::vector<std::array<int, 3>>& faces, std::size_t nb_vertices,
                ConvexPoints& hull) {
  std::set<std::pair<int, int>> edges;
  for (const auto& f : faces) {
    for (int k = 0; k < 3; ++k) {
      const int i = f[k], j = f[(k + 1) % 3];
      edges.insert({i, j});
      edges.insert({j, i});
    }
  }
  hull.first_neighbour.assign(nb_vertices + 1, 0);
  for (const auto& edge : edges) {
    hull.neighbours.push_back(static_cast<std::uint32_t>(edge.second));
    ++hull.first_neighbour[edge.first + 1];
  }
  for (std::size_t i = 0; i < nb_vertices; ++i) {
    hull.first_neighbour[i + 1] += hull.first_neighbour[i];
  }
}

// Each search starts at the result of the previous cell.
void buildStartVertices(ConvexPoints& hull) {
  int vertex = 0;
  for (int cell = 0; cell < NUM_CUBE_CELLS; ++cell) {
    vertex = climb<double>(hull, cubeCellCenter(cell), vertex);
    hull.start.push_back(static_cast<std::uint32_t>(vertex));
  }
}

}  // namespace

ConvexHull convexHull(const std::vector<Eigen::Vector3d>& points) {
  ConvexHull hull;
  std::vector<Eigen::Vector3d> unique = withoutDuplicates(points);
  Qhull qhull;
  const bool solved = unique.size() >= 4 && qhull.run(unique);
  if (solved) hull.faces = triangles(qhull);
  if (hull.faces.empty()) {
    hull.points.vertices = std::move(unique);
    return hull;
  }
  std::vector<int> new_id(unique.size(), -1);
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (auto& f : hull.faces) {
    for (int& i : f) {
      if (new_id[i] < 0) {
        new_id[i] = static_cast<int>(hull.points.vertices.size());
        hull.points.vertices.push_back(unique[i]);
        center += unique[i];
      }
      i = new_id[i];
    }
  }
  center /= static_cast<double>(hull.points.vertices.size());
  hull.volume = volumeAround(center, hull.points.vertices, hull.faces);
  if (hull.points.vertices.size() > CLIMB_ABOVE) {
    buildEdges(hull.faces, hull.points.vertices.size(), hull.points);
    buildStartVertices(hull.points);
  } else {
    appendBlocks(hull.points.vertices, hull.points.blocks);
  }
  return hull;
}

}  // namespace collision_pairs
