// Tables as RFC 4180 has them, and names in their fields.
#pragma once

#include <string>
#include <vector>

namespace collision_pairs {

/// The field as it stands in a table: in quotation marks where it has a comma, a quotation mark, a
/// line break or a blank at an end, or begins with '#', which would read as a comment. Ordinary
/// ones stay as they are.
std::string csvField(const std::string& text);

/// A name that can stand in a list such as "a|b;c|d=0.1", on one line: '%', '|', ';', '=' and
/// control bytes are written as in a URL, "%7C". Ordinary names stay as they are.
std::string listedName(const std::string& name);

/// Reads one record. Blanks around a field count only within quotation marks.
class CsvRecord {
 public:
  /// Takes a line, without its end. False: a quotation mark is open, the record goes on in the next
  /// line.
  bool addLine(const std::string& line);
  const std::vector<std::string>& fields() const { return fields_; }

 private:
  void endField();

  std::vector<std::string> fields_ = {""};
  bool is_quoted_ = false;     // within quotation marks
  std::size_t nb_quoted_ = 0;  // letters of the last field that came within such
};

}  // namespace collision_pairs
