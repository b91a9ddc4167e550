// CSV as in RFC 4180, and names within fields.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace collision_pairs {

/// The field as written to a table: quoted if it contains a comma, a quotation mark or a line
/// break, has a blank at an end, or begins with '#', which would start a comment. Other fields are
/// unchanged.
std::string csvField(const std::string& text);

/// A name for lists such as "a|b;c|d=0.1" on one line: '%', '|', ';', '=' and control bytes are
/// percent-encoded, "%7C". Other names are unchanged.
std::string listedName(const std::string& name);

/// Reads one record. Blanks around a field are significant only within quotation marks.
class CsvRecord {
 public:
  /// Adds a line, without its end. False: a quotation is open and the record continues in the next
  /// line.
  bool addLine(const std::string& line);
  const std::vector<std::string>& fields() const { return fields_; }

 private:
  void endField();

  std::vector<std::string> fields_ = {""};
  bool is_quoted_ = false;                // within quotation marks
  std::optional<std::size_t> nb_quoted_;  // characters of the last field that were quoted, if any
};

}  // namespace collision_pairs
