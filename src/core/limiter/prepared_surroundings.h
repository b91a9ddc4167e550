// Makes the limiter's checkers outside of its decisions.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "certified_surroundings.h"

namespace collision_pairs {

/// Keeps a checker ready for what is wanted now, on a thread of its own, which also destroys the
/// old ones: with large scenes, and at SPHERES, either takes seconds.
class PreparedSurroundings {
 public:
  struct Wanted {
    std::shared_ptr<const CollisionScene> scene;  ///< null: nothing
    Fidelity fidelity = Fidelity::MESH;
    bool operator==(const Wanted& other) const {
      return scene == other.scene && fidelity == other.fidelity;
    }
  };
  using Ask = std::function<Wanted()>;  ///< from both threads
  using Make = std::function<std::shared_ptr<CertifiedSurroundings>(const Wanted&)>;

  PreparedSurroundings(Ask ask, Make make);
  ~PreparedSurroundings();
  PreparedSurroundings(const PreparedSurroundings&) = delete;

  /// Waits for the wanted one until the deadline. It is the caller's until the next call. Throws
  /// InputError if it is not ready then, or what making it threw.
  std::shared_ptr<CertifiedSurroundings> get(const Wanted& wanted,
                                             std::chrono::steady_clock::time_point deadline);

 private:
  void prepare();

  const Ask ask_;
  const Make make_;
  std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  bool ends_ = false;
  bool is_asked_ = false;
  Wanted made_of_;
  std::shared_ptr<CertifiedSurroundings> made_;
  std::string error_;
  std::thread thread_;  // last: it uses the others
};

}  // namespace collision_pairs
