#include "robomill/formats/gcode_codes.hpp"

#include <algorithm>
#include <array>

namespace robomill::formats {
namespace {

struct Still {
  int code;
  GcodeGroup group;
};
constexpr std::array<Still, 17> still = {{{150, GcodeGroup::other},
                                          {400, GcodeGroup::radius},
                                          {430, GcodeGroup::length},
                                          {432, GcodeGroup::length},
                                          {434, GcodeGroup::length},
                                          {435, GcodeGroup::length},
                                          {490, GcodeGroup::length},
                                          {500, GcodeGroup::other},
                                          {610, GcodeGroup::path},
                                          {611, GcodeGroup::path},
                                          {640, GcodeGroup::path},
                                          {690, GcodeGroup::other},
                                          {921, GcodeGroup::other},
                                          {922, GcodeGroup::other},
                                          {970, GcodeGroup::other},
                                          {980, GcodeGroup::other},
                                          {990, GcodeGroup::other}}};

}  // namespace

const GcodeGroup* still_gcode(int code) {
  const auto* const found = std::ranges::find(still, code, &Still::code);
  return found == still.end() ? nullptr : &found->group;
}

const char* gcode_hint(int code) {
  switch (code / 10) {
    case 2:
    case 3:
    case 5:
      return "Let the CAM system write curves as arcs G2, G3 or straight moves";
    case 28:
    case 30:
    case 53:
      return "Where the machine's own positions lie in the part is not known here";
    case 10:
    case 52:
    case 92:
      return "It would move the program's frame";
    case 41:
    case 42:
      return "Let the CAM system write the path of the tool's tip";
    case 43:
      return "It would move the tip by the words that come with it";
    case 51:
    case 68:
    case 16:
    case 7:
      return "It would change what the words of positions mean";
    case 95:
    case 96:
      return "Use G93 or G94, with a spindle speed in rpm";
    default:
      return code >= 730 && code <= 890 ? "Let the CAM system write cycles as straight moves" : "";
  }
}

}  // namespace robomill::formats
