// Reads a text of words and numbers, one word at a time.
#pragma once

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "user_text.h"

namespace collision_pairs {

class MeshWords {
 public:
  /// `text` must outlive this.
  explicit MeshWords(const std::string& text) : text_(text) {}

  /// False at the end of the text; the word is empty then.
  bool next() {
    while (end_ < text_.size() && isBlank(text_[end_])) {
      if (text_[end_] == '\n') ++line_;
      ++end_;
    }
    return readWord();
  }
  /// As next(), but within the line.
  bool nextInLine() {
    while (end_ < text_.size() && text_[end_] != '\n' && isBlank(text_[end_])) ++end_;
    if (end_ < text_.size() && text_[end_] == '\n') {
      begin_ = end_;
      return false;
    }
    return readWord();
  }
  void skipLine() {
    end_ = std::min(text_.find('\n', end_), text_.size());
    begin_ = end_;
  }

  bool is(const char* word) const { return text_.compare(begin_, end_ - begin_, word) == 0; }
  bool isInAnyCase(const char* word) const {
    const std::string given = this->word();
    return given.size() == std::char_traits<char>::length(word) &&
           std::equal(given.begin(), given.end(), word, [](char a, char b) {
             return std::tolower(static_cast<unsigned char>(a)) == b;
           });
  }
  std::string word() const { return text_.substr(begin_, end_ - begin_); }
  /// For messages: its first characters.
  std::string quoted() const {
    constexpr std::size_t ENOUGH = 20;
    if (begin_ == end_) return end_ < text_.size() ? "the end of the line" : "the end of the file";
    const std::size_t length = std::min(end_ - begin_, ENOUGH);
    return "'" + text_.substr(begin_, length) + (length < end_ - begin_ ? "…'" : "'");
  }
  /// False if the word is not a number, or not finite in single precision.
  bool number(float& value) const {
    double exact = 0.0;
    if (!parseNumber(word(), exact)) return false;
    value = static_cast<float>(exact);
    return std::isfinite(value);
  }
  std::size_t line() const { return line_; }
  /// Of the first byte after the word.
  std::size_t position() const { return end_; }

 private:
  static bool isBlank(char c) {
    return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || c == '\0';
  }
  bool readWord() {
    begin_ = end_;
    while (end_ < text_.size() && !isBlank(text_[end_])) ++end_;
    return end_ > begin_;
  }

  const std::string& text_;
  std::size_t begin_ = 0, end_ = 0, line_ = 1;
};

}  // namespace collision_pairs
