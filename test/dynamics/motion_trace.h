// A robot that one thread moves, for others that look at it later.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "simulated_joints.h"

namespace collision_pairs {

/// Where the robot was after each step. Written by one thread, which waits for nobody; others read.
class MotionTrace {
 public:
  MotionTrace(std::size_t nb_joints, std::size_t nb_steps)
      : nb_joints_(nb_joints), numbers_(nb_joints * nb_steps) {}

  /// The next step, of no more than there are.
  void add(const std::vector<double>& positions) {
    const std::size_t step = nb_steps_;
    std::copy(positions.begin(), positions.end(), at(step));
    nb_steps_ = step + 1;
  }
  /// No more steps follow.
  void end() { has_ended_ = true; }

  /// Waits for that step. Throws if the trace ends before.
  std::vector<double> after(std::size_t step) {
    while (nb_steps_ <= step) {
      if (has_ended_ && nb_steps_ <= step) {
        throw std::runtime_error("the robot's motion has ended");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return {at(step), at(step + 1)};
  }

 private:
  std::vector<double>::iterator at(std::size_t step) {
    return numbers_.begin() + static_cast<std::ptrdiff_t>(step * nb_joints_);
  }

  const std::size_t nb_joints_;
  std::vector<double> numbers_;  // of one step after the other
  std::atomic<std::size_t> nb_steps_{0};
  std::atomic<bool> has_ended_{false};
};

/// Is where the trace says, whatever is commanded.
class TracedRobot : public SimulatedRobot {
 public:
  TracedRobot(std::vector<double> positions, std::shared_ptr<MotionTrace> trace)
      : SimulatedRobot(std::move(positions)), trace_(std::move(trace)) {}

 private:
  void move(const std::vector<double>&, double) override { positions_ = trace_->after(step_++); }

  const std::shared_ptr<MotionTrace> trace_;
  std::size_t step_ = 0;
};

}  // namespace collision_pairs
