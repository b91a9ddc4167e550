#include "generated_srdf.h"

#include "xml_file.h"

namespace collision_pairs {
namespace {

/// XML forbids "--" in a comment, and "-" at its end, but names of links may contain them.
std::string commentText(const std::string& text) {
  std::string spaced = " ";
  for (const char c : text) {
    if (c == '-' && spaced.back() == '-') spaced += ' ';
    spaced += c;
  }
  return spaced + ' ';
}

void addLine(const SrdfLine& line, tinyxml2::XMLDocument& document, tinyxml2::XMLElement& robot) {
  if (!line.comment.empty()) {
    robot.InsertEndChild(document.NewComment(commentText(line.comment).c_str()));
  }
  if (line.reason.empty()) return;
  tinyxml2::XMLElement* pair = document.NewElement("disable_collisions");
  pair->SetAttribute("link1", line.first_link.c_str());
  pair->SetAttribute("link2", line.second_link.c_str());
  pair->SetAttribute("reason", line.reason.c_str());
  robot.InsertEndChild(pair);
}

}  // namespace

std::string srdfWithLines(const std::string& given, const std::string& robot_name,
                          const std::vector<SrdfLine>& lines) {
  tinyxml2::XMLDocument document;
  tinyxml2::XMLElement* robot = nullptr;
  if (given.empty()) {
    document.InsertEndChild(document.NewDeclaration());
    robot = document.NewElement("robot");
    robot->SetAttribute("name", robot_name.c_str());
    document.InsertEndChild(robot);
  } else {
    robot = parseXml(document, given, "robot", "SRDF");
  }
  for (const SrdfLine& line : lines) addLine(line, document, *robot);
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

}  // namespace collision_pairs
