// The native narrow phase and FCL on the same poses, pair of shapes by pair of shapes:
//   native_and_fcl OUT.csv [POSES_PER_PAIR]
// A row a pair and method: "native", "fcl" as ~narrow_phase: fcl asks it, and "plain": FCL's own
// collide() and signed distance(), in a process of its own because that may end there.
// scripts/measure_native_and_fcl makes tables and a plot of it.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "every_shape.h"
#include "plain_fcl.h"
#include "signed_distance_oracle.h"

namespace collision_pairs {
namespace {

using Eigen::Isometry3d;

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double SIZE = 0.2;          // metres: of the bodies
constexpr double BAND = 1e-8 * SIZE;  // nearer to touching than this, no verdict is wrong

struct Pose {
  Shape a, b;
  Isometry3d X_AB;
  double truth;  ///< signed distance
};

struct Row {
  int wrong = 0, contradictions = 0, threw = 0, aborted = 0, hung = 0;
  std::uint64_t natively = 0;
  double distance_error = 0.0, depth_error = 0.0;
  std::vector<double> touches_ns, distance_ns;

  void add(double truth, bool touches, double distance) {
    const bool sure = std::abs(truth) > BAND;
    wrong += sure && ((distance <= 0.0) != (truth <= 0.0) || touches != (truth <= 0.0));
    contradictions += touches != (distance <= 0.0);
    if (truth > 0.0 && distance > 0.0) {
      distance_error = std::max(distance_error, std::abs(distance - truth));
    }
    if (truth < 0.0 && distance < 0.0) {
      depth_error = std::max(depth_error, std::abs(distance - truth));
    }
  }
};

template <class Call>
double nanoseconds(Call call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count();
}

// Not for meshes, and not for hulls of many points, of which the oracle tries every three.
bool oracleKnows(const Shape& shape) {
  const auto* convex = std::get_if<Convex>(&shape);
  return !std::holds_alternative<Mesh>(shape) && (!convex || convex->mesh->vertices.size() <= 20);
}

// The native distance, once the oracle has certified it where it can; the oracle's own depth where
// the native one says of itself that it is a bound.
double truthOf(const Shape& a, const Shape& b, const Isometry3d& X_AB, const PairDistance& found) {
  if (!oracleKnows(a) || !oracleKnows(b)) return found.distance;
  const AnswerError error = judge(oracleBody(a), oracleBody(b), X_AB, found, BAND);
  if (found.certainty == Certainty::BOUND && !error.wrong_verdict) {
    return found.distance + error.distance;
  }
  if (error.wrong_verdict || error.distance > 1e-7) {
    std::cerr << "the native distance is off by " << error.distance << " m\n";
    std::exit(1);
  }
  return found.distance;
}

std::vector<Pose> somePoses(RandomInputs& random, const std::string& a, const std::string& b,
                            int count) {
  NarrowPhase native;
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    Pose pose{shapeOfKind(random, a, SIZE), shapeOfKind(random, b, SIZE), {}, 0.0};
    const auto A = prepareShape(pose.a), B = prepareShape(pose.b);
    // A fifth each: up to 1 m apart, nearly touching, nearly apart, 2 mm deep, deeper.
    const double tiny = std::pow(10.0, random.uniform(-9.0, -2.0));
    const double gaps[] = {random.uniform(0.0, 1.0), tiny, -tiny, -0.002, -INF};
    pose.X_AB = poseWithGap(random, native, *A, *B, SIZE, gaps[i % 5]);
    pose.truth = truthOf(pose.a, pose.b, pose.X_AB, native.distance(*A, *B, pose.X_AB, INF));
    poses.push_back(pose);
  }
  return poses;
}

Row measure(const std::vector<Pose>& poses, NarrowPhaseMethod method) {
  Row row;
  NarrowPhase narrow_phase;
  for (const Pose& pose : poses) {
    const auto A = prepareShape(pose.a, method), B = prepareShape(pose.b, method);
    bool touches = false;
    double distance = 0.0;
    row.touches_ns.push_back(
        nanoseconds([&] { touches = narrow_phase.touches(*A, *B, pose.X_AB); }));
    row.distance_ns.push_back(
        nanoseconds([&] { distance = narrow_phase.distance(*A, *B, pose.X_AB, INF).distance; }));
    row.add(pose.truth, touches, distance);
  }
  row.natively = narrow_phase.numAnsweredNatively();
  return row;
}

Row measurePlain(const std::vector<Pose>& poses) {
  Row row;
  std::vector<PlainQuestion> questions;
  for (const Pose& pose : poses) questions.push_back({&pose.a, &pose.b, pose.X_AB});
  const std::vector<PlainAnswer> answers = askPlainFcl(questions);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PlainAnswer& answer = answers[i];
    row.threw += answer.end == PlainAnswer::End::THREW;
    row.aborted += answer.end == PlainAnswer::End::ABORTED;
    row.hung += answer.end == PlainAnswer::End::HUNG;
    if (answer.end != PlainAnswer::End::ANSWERED) continue;
    row.touches_ns.push_back(answer.collide_ns);
    row.distance_ns.push_back(answer.distance_ns);
    row.add(poses[i].truth, answer.collides, answer.distance);
  }
  return row;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void write(std::ostream& csv, const std::string& pair, const char* method, int poses,
           const Row& row) {
  csv << pair << ',' << method << ',' << poses << ',' << row.wrong << ',' << row.contradictions
      << ',' << row.threw << ',' << row.aborted << ',' << row.hung << ',' << row.natively << ','
      << row.distance_error << ',' << row.depth_error;
  for (const auto* ns : {&row.touches_ns, &row.distance_ns}) {
    csv << ',' << quantile(*ns, 0.5) << ',' << quantile(*ns, 0.99);
  }
  csv << std::endl;
}

void measureAll(std::ostream& csv, int count) {
  csv << "pair,method,poses,wrong_verdicts,contradictions,threw,aborted,hung,answered_natively,"
         "distance_error,depth_error,touches_ns,touches_p99_ns,distance_ns,distance_p99_ns\n";
  RandomInputs random;
  for (std::size_t i = 0; i < EVERY_KIND.size(); ++i) {
    for (std::size_t j = i; j < EVERY_KIND.size(); ++j) {
      const std::string pair = EVERY_KIND[i] + "-" + EVERY_KIND[j];
      const std::vector<Pose> poses = somePoses(random, EVERY_KIND[i], EVERY_KIND[j], count);
      write(csv, pair, "native", count, measure(poses, NarrowPhaseMethod::NATIVE));
      write(csv, pair, "fcl", count, measure(poses, NarrowPhaseMethod::FCL));
      write(csv, pair, "plain", count, measurePlain(poses));
    }
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: native_and_fcl OUT.csv [POSES_PER_PAIR]\n";
    return 2;
  }
  std::ofstream csv(argv[1]);
  collision_pairs::measureAll(csv, argc > 2 ? std::atoi(argv[2]) : 1000);
  return 0;
}
