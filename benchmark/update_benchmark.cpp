// update_scene over a persistent connection, with more and more objects in the scene.
//
//   update_benchmark OUT.csv      for the node /collision_pairs_node
//
// Objects are boxes far out of reach. A row holds how long it took to fill the empty scene by one
// request, and the median of adding one box more. The scenes take turns; of each number it is the
// least of all rounds.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <collision_pairs/UpdateScene.h>
#include <ros/ros.h>

namespace collision_pairs {
namespace {

constexpr int ROUNDS = 5, UPDATES = 7;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// On a sphere of 10 m to 50 m, by the golden angle.
SceneChange addBox(std::size_t i) {
  SceneChange change;
  change.operation = SceneChange::ADD;
  change.object.name = "box_" + std::to_string(i);
  const double turn = 2.399963229728653 * static_cast<double>(i);
  const double height = std::cos(static_cast<double>(i));
  const double radius = 10.0 + 40.0 * std::fmod(0.618033988749895 * static_cast<double>(i), 1.0);
  const double across = radius * std::sqrt(1.0 - height * height);
  change.object.pose.position.x = across * std::cos(turn);
  change.object.pose.position.y = across * std::sin(turn);
  change.object.pose.position.z = radius * height;
  change.object.pose.orientation.w = 1.0;
  change.object.primitives.resize(1);
  change.object.primitives[0].type = shape_msgs::SolidPrimitive::BOX;
  change.object.primitives[0].dimensions = {0.1, 0.1, 0.1};
  return change;
}

class Updater {
 public:
  explicit Updater(ros::NodeHandle& node)
      : client_(node.serviceClient<UpdateScene>("/collision_pairs_node/update_scene", true)) {}

  /// Milliseconds of one request.
  double send(std::vector<SceneChange> changes) {
    UpdateScene update;
    update.request.changes = std::move(changes);
    const auto start = std::chrono::steady_clock::now();
    if (!client_.call(update)) throw std::runtime_error("the node does not answer");
    const auto took = std::chrono::steady_clock::now() - start;
    if (!update.response.success) throw std::runtime_error(update.response.message);
    return std::chrono::duration<double, std::milli>(took).count();
  }

 private:
  ros::ServiceClient client_;
};

/// Milliseconds.
struct Row {
  static constexpr double NEVER = std::numeric_limits<double>::infinity();
  double fill = NEVER, update = NEVER;
};

void measureOnce(Updater& updater, std::size_t count, Row& row) {
  SceneChange clear;
  clear.operation = SceneChange::CLEAR;
  updater.send({clear});
  ros::WallDuration(0.2).sleep();  // what was there is freed
  std::vector<SceneChange> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(addBox(i));
  row.fill = std::min(row.fill, updater.send(std::move(all)));
  std::vector<double> updates;
  for (std::size_t i = 0; i < UPDATES; ++i) updates.push_back(updater.send({addBox(count + i)}));
  row.update = std::min(row.update, median(updates));
}

void measure(std::ostream& out) {
  ros::NodeHandle node;
  ros::service::waitForService("/collision_pairs_node/update_scene");
  Updater updater(node);
  std::map<std::size_t, Row> rows = {{10, {}}, {1000, {}}, {100000, {}}};
  for (int round = 0; round < ROUNDS; ++round) {
    for (auto& [count, row] : rows) measureOnce(updater, count, row);
  }
  out << "nb_objects,fill_ms,update_ms\n";
  for (const auto& [count, row] : rows) {
    out << count << ',' << row.fill << ',' << row.update << '\n';
  }
}

}  // namespace
}  // namespace collision_pairs

int main(int argc, char** argv) {
  ros::init(argc, argv, "update_benchmark");
  if (argc != 2) {
    std::cerr << "usage: update_benchmark OUT.csv\n";
    return 2;
  }
  std::ofstream out(argv[1]);
  try {
    collision_pairs::measure(out);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return out ? 0 : 1;
}
