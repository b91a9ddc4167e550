#include "collision_pairs/input_error.h"

#include <algorithm>

namespace collision_pairs {
namespace {

constexpr std::size_t LONGEST = 1000;  // bytes
constexpr const char ELLIPSIS[] = " … ";
// Bytes kept of longer texts.
constexpr std::size_t BEGIN = 600, END = LONGEST - BEGIN - (sizeof ELLIPSIS - 1);

bool isControl(char byte) {  // char is unsigned on arm64
  constexpr char DELETE = 0x7f;
  return static_cast<unsigned char>(byte) < ' ' || byte == DELETE;
}

// Does not split a UTF-8 character.
bool isWithinCharacter(char byte) { return (static_cast<unsigned char>(byte) & 0xC0u) == 0x80u; }

std::string printable(std::string text) {
  if (text.size() > LONGEST) {
    std::size_t begin = BEGIN, end = text.size() - END;
    while (begin > 0 && isWithinCharacter(text[begin])) --begin;
    while (end < text.size() && isWithinCharacter(text[end])) ++end;
    text = text.substr(0, begin) + ELLIPSIS + text.substr(end);
  }
  std::replace_if(text.begin(), text.end(), isControl, ' ');
  return text;
}

}  // namespace

InputError::InputError(std::string message) : std::runtime_error(printable(std::move(message))) {}

}  // namespace collision_pairs
