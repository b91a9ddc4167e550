#include "pcd_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "collision_pairs/input_error.h"
#include "user_text.h"

namespace collision_pairs {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t MOST_IN_A_FIELD = 1u << 20;  // bytes, and values

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// A column of each point: where its values begin.
struct Column {
  std::uint64_t byte = 0, bytes_a_value = 0;
  std::uint64_t value = 0;
};

constexpr std::size_t MOST_OF_A_BYTE = (7 + 255 + 2) / 3;  // LZF: the longest copy is three

/// LZF (Marc Lehmann 2000), a sequence of runs that begin with a byte c. c < 32: the c + 1 bytes
/// that follow are copied. Otherwise c >> 5 is a length, 7: to which the next byte is added; the
/// next byte and, above it, c & 31 are an offset; length + 2 bytes are copied from offset + 1
/// before the end of what there is, which may grow over what is copied. Cost: linear.
class LzfReader {
 public:
  /// `size`: of what is read; nothing is allocated for one that cannot be true.
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

class PcdReader {
 public:
  explicit PcdReader(const std::string& bytes) : bytes_(bytes) {}

  std::vector<Vector3d> read() {
    while (data_.empty()) readHeaderLine();
    layOut();
    if (data_ == "ascii") return readAscii();
    if (data_ == "binary") return readBinary();
    if (data_ == "binary_compressed") return readCompressed();
    fail("DATA is '" + data_.substr(0, 20) + "', but must be ascii, binary or binary_compressed");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("line " + std::to_string(nb_lines_) + ": " + what);
  }

  [[noreturn]] void failAfter(std::uint64_t nb_points) const {
    throw InputError("it should have " + std::to_string(*nb_points_) + " points, but ends after " +
                     std::to_string(nb_points) + " (truncated?)");
  }

  bool nextLine(std::string& line) {
    if (at_ >= bytes_.size()) return false;
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    line = bytes_.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes_.size());
    ++nb_lines_;
    return true;
  }

  void readHeaderLine() {
    std::string line;
    if (!nextLine(line))
      throw InputError("it has no DATA line: it is not a PCD file, or is truncated");
    std::vector<std::string> words = wordsOf(line);
    if (words.empty() || words[0][0] == '#') return;
    const std::string keyword = words[0];
    words.erase(words.begin());
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      fields_ = words;
    } else if (keyword == "SIZE") {
      sizes_ = numbers(keyword, words);
    } else if (keyword == "TYPE") {
      types_ = words;
    } else if (keyword == "COUNT") {
      counts_ = numbers(keyword, words);
    } else if (keyword == "WIDTH") {
      width_ = number(keyword, words);
    } else if (keyword == "HEIGHT") {
      height_ = number(keyword, words);
    } else if (keyword == "POINTS") {
      nb_points_ = number(keyword, words);
    } else if (keyword == "DATA") {
      if (words.size() != 1) fail("DATA must be one word");
      data_ = words[0];
    } else if (keyword != "VERSION" && keyword != "VIEWPOINT") {
      fail("'" + keyword.substr(0, 20) + "' is not a keyword of a PCD header");
    }
  }

  std::vector<std::uint64_t> numbers(const std::string& keyword,
                                     const std::vector<std::string>& words) const {
    std::vector<std::uint64_t> values;
    for (const std::string& word : words) {
      double value = 0.0;
      const bool is_whole = parseNumber(word, value) && value >= 0.0 && value < 4e9 &&
                            value == static_cast<double>(static_cast<std::uint64_t>(value));
      if (!is_whole) fail(keyword + ": '" + word.substr(0, 20) + "' is not a whole number");
      values.push_back(static_cast<std::uint64_t>(value));
    }
    return values;
  }
  std::uint64_t number(const std::string& keyword, const std::vector<std::string>& words) const {
    if (words.size() != 1) fail(keyword + " must have one number");
    return numbers(keyword, words)[0];
  }

  void layOut() {
    if (fields_.empty()) fail("there is no FIELDS line");
    if (counts_.empty()) counts_.assign(fields_.size(), 1);
    const std::size_t wanted = fields_.size();
    if (sizes_.size() != wanted || types_.size() != wanted || counts_.size() != wanted) {
      fail("FIELDS, SIZE, TYPE and COUNT differ in length");
    }
    for (std::size_t i = 0; i < wanted; ++i) {
      if (sizes_[i] > MOST_IN_A_FIELD || counts_[i] > MOST_IN_A_FIELD) {
        fail("field '" + fields_[i].substr(0, 20) + "' is too large");
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (fields_[i] == std::string(1, "xyz"[axis])) placeColumn(i, axis);
      }
      point_bytes_ += sizes_[i] * counts_[i];
      point_values_ += counts_[i];
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!columns_[axis]) fail(std::string("there is no field ") + "xyz"[axis]);
    }
    if (!nb_points_) {
      if (!width_ || !height_) fail("there is neither POINTS nor WIDTH and HEIGHT");
      nb_points_ = *width_ * *height_;
    } else if (width_ && height_ && *width_ * *height_ != *nb_points_) {
      fail("POINTS is " + std::to_string(*nb_points_) + ", but WIDTH times HEIGHT is " +
           std::to_string(*width_ * *height_));
    }
  }

  void placeColumn(std::size_t field, std::size_t axis) {
    const bool is_float = types_[field] == "F" && (sizes_[field] == 4 || sizes_[field] == 8);
    if (!is_float || counts_[field] != 1) {
      fail("field " + fields_[field] + " must be one number of TYPE F and SIZE 4 or 8");
    }
    if (columns_[axis]) fail("field " + fields_[field] + " occurs twice");
    columns_[axis] = Column{point_bytes_, sizes_[field], point_values_};
  }

  std::string_view data() const { return std::string_view(bytes_).substr(at_); }

  /// Points that nobody would see. Older versions of PCL fill the last page with zeros.
  void refuseAfter(std::size_t end) const {
    if (data().find_first_not_of('\0', end) == std::string_view::npos) return;
    throw InputError("its data go on after the " + std::to_string(*nb_points_) +
                     " points that its header says");
  }

  std::vector<Vector3d> readBinary() const {
    const std::uint64_t given = data().size() / point_bytes_;
    if (given < *nb_points_) failAfter(given);
    refuseAfter(*nb_points_ * point_bytes_);
    std::vector<Vector3d> points(*nb_points_);
    for (int axis = 0; axis < 3; ++axis) {
      const Column& column = *columns_[static_cast<std::size_t>(axis)];
      readColumn(data().data() + column.byte, point_bytes_, column.bytes_a_value, axis, points);
    }
    return points;
  }

  /// The sizes of the data, compressed and not, and the compressed data: each field of all points
  /// after the one before.
  std::vector<Vector3d> readCompressed() const {
    std::array<std::uint32_t, 2> sizes{};
    if (*nb_points_ == 0) {
      refuseAfter(0);
      return {};
    }
    if (data().size() < sizeof sizes) failAfter(0);
    std::memcpy(sizes.data(), data().data(), sizeof sizes);
    if (sizes[1] / point_bytes_ != *nb_points_ || sizes[1] % point_bytes_ != 0) {
      throw InputError("it should have " + std::to_string(*nb_points_) + " points of " +
                       std::to_string(point_bytes_) + " bytes, but its data claim " +
                       std::to_string(sizes[1]) + " bytes");
    }
    const std::string_view compressed = data().substr(sizeof sizes);
    if (compressed.size() < sizes[0]) failAfter(0);
    refuseAfter(sizeof sizes + sizes[0]);
    const std::string fields = LzfReader(compressed.substr(0, sizes[0]), sizes[1]).read();
    std::vector<Vector3d> points(*nb_points_);
    for (int axis = 0; axis < 3; ++axis) {
      const Column& column = *columns_[static_cast<std::size_t>(axis)];
      readColumn(fields.data() + column.byte * points.size(), column.bytes_a_value,
                 column.bytes_a_value, axis, points);
    }
    return points;
  }

  /// One coordinate of all points: values of 4 or 8 bytes, `stride` bytes apart.
  static void readColumn(const char* at, std::size_t stride, std::size_t bytes_a_value, int axis,
                         std::vector<Vector3d>& points) {
    for (Vector3d& point : points) {
      if (bytes_a_value == 4) {
        float value = 0.0f;
        std::memcpy(&value, at, sizeof value);
        point[axis] = value;
      } else {
        std::memcpy(&point[axis], at, sizeof(double));
      }
      at += stride;
    }
  }

  std::vector<Vector3d> readAscii() {
    std::vector<Vector3d> points;
    for (std::string line; nextLine(line);) {
      const std::vector<std::string> words = wordsOf(line);
      if (words.empty()) continue;
      if (words.size() != point_values_) {
        fail(std::to_string(words.size()) + " values, but the fields have " +
             std::to_string(point_values_));
      }
      if (points.size() == *nb_points_) fail("there are more points than POINTS says");
      Vector3d point;
      for (int axis = 0; axis < 3; ++axis) {
        const std::string& word = words[columns_[static_cast<std::size_t>(axis)]->value];
        point[axis] = coordinate(word);
      }
      points.push_back(point);
    }
    if (points.size() < *nb_points_) failAfter(points.size());
    return points;
  }

  double coordinate(const std::string& word) const {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (parseNumber(word, value)) return value;
    std::string lower = word;
    for (char& letter : lower) letter = letter >= 'A' && letter <= 'Z' ? char(letter + 32) : letter;
    for (const char* none : {"nan", "-nan", "inf", "-inf"}) {
      if (lower == none) return std::numeric_limits<double>::quiet_NaN();
    }
    fail("'" + word.substr(0, 20) + "' is not a number");
  }

  const std::string& bytes_;
  std::size_t at_ = 0, nb_lines_ = 0;
  std::vector<std::string> fields_, types_;
  std::vector<std::uint64_t> sizes_, counts_;
  std::optional<std::uint64_t> width_, height_, nb_points_;
  std::string data_;
  std::array<std::optional<Column>, 3> columns_;
  std::uint64_t point_bytes_ = 0, point_values_ = 0;
};

}  // namespace

std::vector<Vector3d> readPcd(const std::string& bytes) { return PcdReader(bytes).read(); }

}  // namespace collision_pairs
