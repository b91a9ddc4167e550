#include "lzf.h"

#include <cstdint>
#include <utility>

#include "collision_pairs/input_error.h"

namespace collision_pairs {
namespace {

constexpr std::size_t MOST_OF_A_BYTE = (7 + 255 + 2) / 3;  // the longest copy is three bytes

class LzfReader {
 public:
  LzfReader(std::string_view compressed, std::size_t size) : left_(compressed), size_(size) {
    if (size / MOST_OF_A_BYTE > compressed.size())
      fail("they are too short for what they claim to hold");
    text_.reserve(size);
  }

  std::string read() {
    while (!left_.empty()) {
      const std::size_t control = next();
      if (control < 32) {
        takeLiterally(control + 1);
      } else {
        copy(control);
      }
    }
    if (text_.size() != size_) fail("they end too early");
    return std::move(text_);
  }

 private:
  [[noreturn]] static void fail(const std::string& why) {
    throw InputError("the compressed data are damaged: " + why);
  }

  std::size_t next() {
    if (left_.empty()) fail("they end within a run");
    const auto byte = static_cast<std::uint8_t>(left_.front());
    left_.remove_prefix(1);
    return byte;
  }

  void requireRoom(std::size_t count) const {
    if (count > size_ - text_.size()) fail("they hold more than they claim");
  }

  void takeLiterally(std::size_t count) {
    requireRoom(count);
    if (count > left_.size()) fail("they end within a run");
    text_.append(left_.substr(0, count));
    left_.remove_prefix(count);
  }

  void copy(std::size_t control) {
    std::size_t count = control >> 5;
    if (count == 7) count += next();
    count += 2;
    const std::size_t offset = ((control & 31) << 8) + next() + 1;
    requireRoom(count);
    if (offset > text_.size()) fail("they refer to what is before their beginning");
    for (; count > 0; --count) text_.push_back(text_[text_.size() - offset]);
  }

  std::string_view left_;
  const std::size_t size_;
  std::string text_;
};

}  // namespace

std::string decompressLzf(std::string_view compressed, std::size_t size) {
  return LzfReader(compressed, size).read();
}

}  // namespace collision_pairs
