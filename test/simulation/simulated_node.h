// A monitor to which events happen, beside an oracle that is told the same.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <collision_pairs/Scene.h>

#include "monitored_robot.h"
#include "plain_knowledge.h"
#include "simulated_limiter.h"

namespace simulation {

using namespace collision_pairs;

constexpr Ns BEGIN = 1000000000000;                      // of ROS time
constexpr double LONGEST_WAIT = 1.0;                     // s, of the cloud
constexpr double SELF_FILTER = 0.02, MAX_RANGE = 100.0;  // m
constexpr double ALARM_DISTANCE = 0.3;                   // m
constexpr double NEW_RUN = 5.0;                          // s: /clock goes back by more

/// An object of the scene.
struct PlainObject {
  Solid solid;
  int link = -1;          ///< that it is attached to; -1: it stands
  Pose X_PO;              ///< in the link, or in the root's frame
  std::set<int> touches;  ///< links
  std::set<std::string> touched_objects = {};
};

/// Parameters that change.
struct PlainSettings {
  std::set<int> ignored = {};   ///< links
  int broken = -1;              ///< link with a mesh that cannot be read; -1: none
  double padding = 0.0;         ///< m, of each link
  double source_timeout = 1.0;  ///< s; 0: none
};

/// Runs one sequence of events. After each, `violation` says what is wrong; empty: nothing.
class SimulatedNode {
 public:
  explicit SimulatedNode(const Scenario& setup);

  void happen(const Event& event);
  /// Everything is said again, apart, and by one node each, for that long [s].
  void recover(double duration);
  /// The report at this time, which is judged.
  void report();

  const std::string& violation() const { return violation_; }
  Verdict verdict() const { return report_.verdict; }
  std::string reasons() const;
  /// Of all reports.
  std::size_t digest() const { return digest_; }
  std::map<Verdict, int> counts;
  int nb_limited = 0;  ///< moments at which the limiter could decide

 private:
  struct SceneWork {
    SceneJob job;
    std::uint64_t revision;
    std::map<std::string, PlainObject> objects;  ///< afterwards
    PlainSettings settings;
    bool may_show_more;  ///< of the clouds: what was attached hid it
  };
  /// What a change has to ask TF about.
  struct PoseQuestion {
    int link = -1;  ///< -1: nothing
    Ns stamp = 0;   ///< 0: the newest
  };
  /// Of the last cloud that was used.
  struct Seen {
    double measured = 0.0;
    std::vector<Pose> points;       ///< in W, but for the robot's own
    std::uint64_t revision = 0;     ///< of the scene that it was filtered with
    std::vector<Pose> before = {};  ///< points of the cloud before
  };

  struct SentCloud {
    Ns stamp;
    int what;
    std::vector<Pose> points;  ///< in the camera's frame
    double arrival;            ///< s, of ROS time
    int pass;
    std::string publisher;
    double since = 0.0;                     ///< of wall time, when it was looked at first
    bool is_new = true, may_be_new = true;  ///< it was not looked at yet
  };
  /// What is in use since clouds were cleared.
  struct UsedCloud {
    double measured;
    int pass;
    std::uint64_t revision;  ///< of the scene that it was filtered with
  };

  geometry_msgs::Pose message(const Pose& pose) const;
  Eigen::Vector3d inSpace(const Pose& pose) const;
  void place(geometry_msgs::TransformStamped& transform, const Pose& pose) const;
  void advance(double dt);
  Ns stampOf(double lag) const;
  void publish(const std::string& parent, const std::string& link, Ns stamp, const Pose& X_PB,
               const std::string& publisher, bool is_static);
  void publish(int link, const std::string& publisher);
  void take(const tf2_msgs::TFMessage& tf, bool is_static, const std::string& publisher);
  void lie(const Event& event);
  void publishBroken(const Event& event);
  void publishCamera(const Pose& X_LC);
  void sendCloud(const Event& event);
  void takeCloud(const sensor_msgs::PointCloud2::ConstPtr& message, const SentCloud& cloud);
  bool isOfOtherCamera(const SentCloud& cloud) const;
  void beginCloud();
  void endCloud();
  void clearClouds();
  void noteCleared();
  void forgetClouds();
  double timeout() const { return settings_.source_timeout > 0.0 ? settings_.source_timeout : 1e9; }
  bool arePosesCertain(Ns stamp) const;
  bool isSound(const SentCloud& cloud) const;
  void requireRefusable(const SentCloud& cloud);
  bool hasNoUsableStamp(const SentCloud& cloud) const;
  void requireUsable(const SentCloud& cloud);
  std::string expectedCloudProblem(bool is_refused) const;
  void judgeClouds(const Snapshot& snapshot);
  int nbCloudsHere() const;
  void noteUse(double latency);
  bool isAnyLost() const;
  void judgeHealth(const CloudHealth& health);
  void beginScene(const Event& event);
  void endScene(bool is_first);
  std::optional<Ns> newestStampOf(int link, Ns now) const;
  std::optional<Pose> newestPoseOf(int link) const;
  SceneParameters parameters(const PlainSettings& wanted) const;
  void readAgain();
  void judgeObjects();
  bool isStale(const PoseQuestion& question) const;
  bool isAnswered(const PoseQuestion& question) const;

  void request(const Event& event);
  void requestAt(Ns stamp);
  void requireOfThen(Ns stamp, const std::vector<std::string>& reasons);
  void requestJoints(const Event& event, Ns at_stamp);
  void requestPart(const Event& event);
  void requestReplaced();
  void requireRefusal(const std::vector<std::string>& words, const std::function<void()>& attempt);
  void requestWrong();
  void requestInCycle();
  void requestWrongScenes();
  void judgeListed(const collision_pairs::Scene& message);

  void judge(const Snapshot& snapshot);
  void noteTransform(int link, const std::optional<std::string>& refusal);
  void noteHeard(int link, Ns stamp, bool is_new);
  void judgeRefusals(const Snapshot& snapshot);
  void judgeReasons(const Snapshot& snapshot);
  void judgeLeftOut(const Snapshot& snapshot);
  void judgeWords(const std::string& reason);
  void judgeJointsOf(const JointQuery& query, const std::vector<std::string>& names);
  void judgeLagging(const Snapshot& limited);
  bool isGeometryMissing() const;
  void judgeFree(const Snapshot& snapshot);
  void judgeBodies(const Snapshot& snapshot, bool is_newest = false);
  bool isRootNowhere(const Snapshot& snapshot) const;
  void judgeCertain(const Snapshot& snapshot);
  void judgePairs(const Snapshot& snapshot);
  void judgeContacts(const PairReport& pair, const std::string& a, const std::string& b,
                     double gap);
  void judgeBefore(const Snapshot& snapshot);
  void judgeMessage(const Snapshot& snapshot);
  void judgeSame(const Snapshot& snapshot);
  using Poses = std::vector<std::optional<Pose>>;  ///< of links; nothing: it is not known
  Poses posesAt(Ns stamp) const;
  /// Of all pairs, or of those with one of these members.
  void judgeApart(const Poses& at, const std::set<std::string>& members = {});
  Pose poseOf(const PlainObject& object, const Poses& at) const;
  bool isPlaced(const PlainObject& object, const Poses& at) const {
    return object.link < 0 || at[static_cast<std::size_t>(object.link)];
  }
  Solid ballOf(int link) const {
    return {false, setup_.links[static_cast<std::size_t>(link)].radius, {}};
  }
  bool isBody(int link, const Eigen::Isometry3d& X_WB, Ns stamp) const;
  void judgeAgreement(const Snapshot& snapshot);
  void requireSharedReasons(const Snapshot& cycle, const Snapshot& other, const std::string& whose);
  void judgeMemory();
  bool isCheckedAgainst(int link, const PlainObject& object) const;
  bool areChecked(int i, int j) const;
  bool mayBeChecked(int i, int j) const;
  bool isOneOf(const std::set<std::string>& members, const std::string& a,
               const std::string& b) const;
  bool isAnyChecked(const std::set<std::string>& members) const;
  int bodyOf(int link) const;
  bool areAdjacent(int a, int b) const;
  void fail(const std::string& what);

  const Scenario setup_;
  Monitor monitor_;
  Knowledge knowledge_;
  std::optional<SimulatedLimiter> limiter_;  ///< if a joint slides or turns
  Ns clock_ = 0, ros_ = 0;                   ///< what the clock says, and what counts
  double steady_ = 0.0, speed_ = 1.0;
  std::vector<std::pair<Ns, Said>> last_;  ///< of each link
  std::vector<char> stands_;               ///< of each link: it is published on /tf_static
  /// Of each link whose last transform was certainly refused, or right: why, and when.
  std::map<int, std::pair<std::string, double>> refusals_;
  std::uint64_t nb_refused_ = 0;  ///< before the last transform
  std::map<std::string, PlainObject> objects_;
  PlainSettings settings_;
  std::uint64_t revision_ = 0;
  Ns changed_ = 0;  ///< when the scene was, since the clock went back
  std::vector<SceneWork> scene_works_;
  ActiveScenePtr replaced_;                 ///< some earlier scene, or part of one
  std::unique_ptr<SceneStore> read_again_;  ///< the scene, as its message says
  std::shared_ptr<CloudJob> cloud_work_;
  std::vector<Pose> cloud_points_;  ///< in W, of cloud_work_
  std::optional<SentCloud> next_cloud_, waiting_cloud_;
  Pose obstacle_;                            ///< in W, of the last cloud
  sensor_msgs::PointCloud2::ConstPtr sent_;  ///< the last, which may be sent again
  SentCloud sent_cloud_;
  SentCloud sent_work_;  ///< of cloud_work_
  std::optional<UsedCloud> used_cloud_;
  /// Which node sent those that are used, in which pass, and when the last was used.
  struct UsedCamera {
    std::string publisher;
    int pass;
    double last_use;
  };
  std::optional<UsedCamera> camera_;
  std::optional<double> other_camera_;  ///< when clouds of another were refused last, s
  bool is_cloud_refused_ = false;       ///< the last, or it waits for what nobody connects
  bool may_cloud_be_refused_ = false;
  int nb_clouds_ = 0, nb_cleared_ = 0, nb_used_ = 0;
  double last_use_ = 0.0, rate_ = 0.0, latency_ = 0.0;  ///< of clouds that were used
  std::size_t sent_points_ = 0;
  std::size_t most_voxels_ = 0;  ///< points of the clouds that count since they were cleared
  int cloud_generation_ = 0, cloud_work_generation_ = 0, cloud_work_pass_ = 0;
  std::uint64_t cloud_work_revision_ = 0, complete_revision_ = 0;
  Ns last_cloud_ = 0;  ///< stamp of the last that was used
  std::optional<Seen> seen_;
  bool is_lost_ = false;   ///< what was beside the robot is not in the last cloud
  bool was_lost_ = false;  ///< … when the clock went back, or the source was replaced
  bool is_camera_told_ = false;
  Pose X_LC_;
  CollisionReport report_;
  std::unique_ptr<CollisionDetector> detector_;
  std::size_t digest_ = 0;
  std::string violation_;
};

}  // namespace simulation
