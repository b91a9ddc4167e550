#include "plain_fcl.h"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>

#include <fcl/fcl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "convex_hull.h"

namespace collision_pairs {
namespace {

using fcl::Transform3d;
using Object = std::shared_ptr<fcl::CollisionGeometryd>;

constexpr int PATIENCE_MS = 2000;

struct MakeObject {
  Object operator()(const Box& box) { return std::make_shared<fcl::Boxd>(box.size); }
  Object operator()(const Sphere& sphere) { return std::make_shared<fcl::Sphered>(sphere.radius); }
  Object operator()(const Cylinder& c) {
    return std::make_shared<fcl::Cylinderd>(c.radius, c.length);
  }
  Object operator()(const Capsule& c) {
    return std::make_shared<fcl::Capsuled>(c.radius, c.length);
  }
  Object operator()(const HalfSpace&) { return nullptr; }
  Object operator()(const Convex& convex) {
    const ConvexHull hull = convexHull(convex.mesh->vertices);
    auto faces = std::make_shared<std::vector<int>>();
    for (const auto& f : hull.faces) faces->insert(faces->end(), {3, f[0], f[1], f[2]});
    return std::make_shared<fcl::Convexd>(
        std::make_shared<std::vector<Eigen::Vector3d>>(hull.points.vertices),
        static_cast<int>(hull.faces.size()), faces);
  }
  Object operator()(const Mesh& shape) {
    auto tree = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
    std::vector<fcl::Triangle> triangles;
    for (const auto& t : shape.mesh->triangles) triangles.emplace_back(t[0], t[1], t[2]);
    tree->beginModel();
    tree->addSubModel(shape.mesh->vertices, triangles);
    tree->endModel();
    return tree;
  }
};

template <class Call>
double nanoseconds(Call call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

PlainAnswer ask(const PlainQuestion& question) {
  PlainAnswer answer;
  const Object a = std::visit(MakeObject(), *question.a), b = std::visit(MakeObject(), *question.b);
  const Transform3d X_A = Transform3d::Identity(), X_B(question.X_AB.matrix());
  try {
    fcl::CollisionResultd contact;
    answer.collide_ns = nanoseconds([&] {
      fcl::collide(a.get(), X_A, b.get(), X_B, fcl::CollisionRequestd(1, false), contact);
    });
    fcl::DistanceResultd nearest;
    answer.distance_ns = nanoseconds([&] {
      fcl::distance(a.get(), X_A, b.get(), X_B, fcl::DistanceRequestd(true, true), nearest);
    });
    answer.collides = contact.isCollision();
    answer.distance = nearest.min_distance;
    answer.end = PlainAnswer::End::ANSWERED;
  } catch (const std::exception&) {
    answer.end = PlainAnswer::End::THREW;
  }
  return answer;
}

// Writes one answer after the other, as far as it comes.
[[noreturn]] void answerInChild(const std::vector<PlainQuestion>& questions, std::size_t from,
                                int pipe_end) {
  std::freopen("/dev/null", "w", stderr);  // what asserts say
  for (std::size_t i = from; i < questions.size(); ++i) {
    const PlainAnswer answer = ask(questions[i]);
    if (::write(pipe_end, &answer, sizeof answer) != sizeof answer) break;
  }
  ::_exit(0);
}

}  // namespace

std::vector<PlainAnswer> askPlainFcl(const std::vector<PlainQuestion>& questions) {
  std::vector<PlainAnswer> answers;
  while (answers.size() < questions.size()) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) answerInChild(questions, answers.size(), ends[1]);
    ::close(ends[1]);
    PlainAnswer answer;
    pollfd waiting{ends[0], POLLIN, 0};
    while (answers.size() < questions.size()) {
      const bool in_time = ::poll(&waiting, 1, PATIENCE_MS) == 1;
      if (in_time && ::read(ends[0], &answer, sizeof answer) == sizeof answer) {
        answers.push_back(answer);
        continue;
      }
      answer = PlainAnswer();
      answer.end = in_time ? PlainAnswer::End::ABORTED : PlainAnswer::End::HUNG;
      answers.push_back(answer);
      break;
    }
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ::close(ends[0]);
  }
  return answers;
}

}  // namespace collision_pairs
