#include "csv.h"

#include <algorithm>
#include <cstring>

#include "user_text.h"

namespace collision_pairs {
namespace {

const char* const BLANKS = " \t\r";

bool isAtomic(unsigned char byte) {
  constexpr unsigned char DELETE = 0x7f;
  const bool is_control = byte < ' ' || byte == DELETE;
  return !is_control && byte != '%' && byte != '|' && byte != ';' && byte != '=';
}

}  // namespace

std::string csvField(const std::string& text) {
  if (text.empty()) return text;
  const std::string ends = {text.front(), text.back()};
  if (text.find_first_of(",\"\r\n") == text.npos && ends.find_first_of(BLANKS) == ends.npos &&
      text.front() != '#') {
    return text;
  }
  std::string field = "\"";
  for (const char letter : text) field += letter == '"' ? "\"\"" : std::string(1, letter);
  return field + '"';
}

std::string listedName(const std::string& name) {
  std::string text;
  for (const char letter : name) {
    const auto byte = static_cast<unsigned char>(letter);
    text += isAtomic(byte) ? std::string(1, letter) : formatted("%%%02X", byte);
  }
  return text;
}

bool CsvRecord::addLine(const std::string& line) {
  if (is_quoted_) fields_.back() += '\n';
  for (std::size_t i = 0; i < line.size(); ++i) {
    std::string& field = fields_.back();
    if (is_quoted_) {
      const bool is_doubled = line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"';
      is_quoted_ = line[i] != '"' || is_doubled;
      if (is_quoted_) field += line[i];
      if (is_doubled) ++i;
      nb_quoted_ = field.size();
    } else if (line[i] == ',') {
      endField();
      fields_.emplace_back();
    } else if (line[i] == '"' && !nb_quoted_ && field.find_first_not_of(BLANKS) == field.npos) {
      field.clear();
      is_quoted_ = true;
    } else {
      // Behind a quotation: the quote comes back, so that nobody takes "0"1 for a number.
      const bool is_first =
          nb_quoted_ && field.find_first_not_of(BLANKS, *nb_quoted_) == field.npos;
      if (is_first && std::strchr(BLANKS, line[i]) == nullptr) field.insert(*nb_quoted_, 1, '"');
      field += line[i];
    }
  }
  if (!is_quoted_) endField();
  return !is_quoted_;
}

void CsvRecord::endField() {
  std::string& field = fields_.back();
  const std::size_t last = field.find_last_not_of(BLANKS);
  field.erase(std::max(nb_quoted_.value_or(0), last + 1));  // none found: npos + 1 is 0
  if (!nb_quoted_) field.erase(0, field.find_first_not_of(BLANKS));
  nb_quoted_.reset();
}

}  // namespace collision_pairs
