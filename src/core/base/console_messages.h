// Some libraries (urdfdom, geometric_shapes) report errors only to console_bridge.
#pragma once

#include <mutex>
#include <string>

#include <console_bridge/console.h>

namespace collision_pairs {

/// During its lifetime, console_bridge's errors are collected here instead of being printed, so
/// that they can become part of our own message. It holds a lock because console_bridge has one
/// handler per process.
class ConsoleMessages : public console_bridge::OutputHandler {
 public:
  ConsoleMessages() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~ConsoleMessages() override { console_bridge::restorePreviousOutputHandler(); }
  ConsoleMessages(const ConsoleMessages&) = delete;
  ConsoleMessages& operator=(const ConsoleMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_error_.empty()) {
      first_error_ = text;
    }
  }
  /// Empty if there was none.
  const std::string& firstError() const { return first_error_; }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  std::string first_error_;
};

}  // namespace collision_pairs
