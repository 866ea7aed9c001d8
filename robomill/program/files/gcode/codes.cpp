#include "robomill/program/files/gcode/codes.hpp"

#include <algorithm>
#include <array>
#include <functional>

namespace robomill::program {
namespace {

struct Still {
  int code;
  GcodeGroup group;
};
/// Look-ahead, smoothing, exact stop, and modes that are turned off: no position changes its meaning.
constexpr std::array<Still, 34> still = {{
    {50, GcodeGroup::other},   {51, GcodeGroup::other},   {80, GcodeGroup::other},   {90, GcodeGroup::other},
    {131, GcodeGroup::other},  {150, GcodeGroup::other},  {220, GcodeGroup::other},  {230, GcodeGroup::other},
    {250, GcodeGroup::other},  {281, GcodeGroup::other},  {301, GcodeGroup::other},  {400, GcodeGroup::radius},
    {401, GcodeGroup::other},  {430, GcodeGroup::length}, {434, GcodeGroup::length}, {435, GcodeGroup::length},
    {490, GcodeGroup::length}, {500, GcodeGroup::other},  {501, GcodeGroup::other},  {542, GcodeGroup::other},
    {610, GcodeGroup::path},   {611, GcodeGroup::path},   {620, GcodeGroup::path},   {630, GcodeGroup::path},
    {640, GcodeGroup::path},   {670, GcodeGroup::other},  {970, GcodeGroup::other},  {1000, GcodeGroup::other},
    {1030, GcodeGroup::other}, {1130, GcodeGroup::other}, {1870, GcodeGroup::path},  {2340, GcodeGroup::length},
    {2550, GcodeGroup::other}, {2690, GcodeGroup::other},
}};

/// LinuxCNC's reference of M codes, the mill manuals of Haas (Fanuc's where they agree), and Heidenhain's of its ISO
/// programs. A code that means motion or order on one of them is rejected on all, because a file does not say whose it
/// is. Where nothing else is said, M100 to M199 are the user's own in LinuxCNC.
constexpr std::array<Mcode, 86> mcode_rows = {{
    {0, McodeAct::stop, "pauses the program", "stops the program", "stops the program"},
    {1, McodeAct::optional_stop, "pauses the program where the switch is on", "stops where the switch is on",
     "stops where the switch is on"},
    {2, McodeAct::end, "ends the program", "ends the program", "ends the program"},
    {3, McodeAct::spindle_clockwise, "spindle clockwise", "spindle clockwise", "spindle clockwise"},
    {4, McodeAct::spindle_counterclockwise, "spindle counter-clockwise", "spindle counter-clockwise",
     "spindle counter-clockwise"},
    {5, McodeAct::spindle_off, "spindle off", "spindle off", "spindle off"},
    {6, McodeAct::tool_change, "changes the tool", "changes the tool", "changes the tool"},
    {7, McodeAct::mist, "mist on", "mist or shower on", ""},
    {8, McodeAct::flood, "flood on", "flood on", "coolant on"},
    {9, McodeAct::coolant_off, "coolant off", "coolant off", "coolant off"},
    {10, McodeAct::nothing, "", "clamps the fourth axis", ""},
    {11, McodeAct::nothing, "", "releases the fourth axis", ""},
    {12, McodeAct::nothing, "", "clamps the fifth axis", ""},
    {13, McodeAct::rejected, "", "releases the fifth axis", "spindle clockwise and coolant on"},
    {14, McodeAct::rejected, "", "", "spindle counter-clockwise and coolant on"},
    {16, McodeAct::tool_change, "", "changes the tool", ""},
    {19, McodeAct::spindle_off, "orients the spindle", "orients the spindle", "orients the spindle"},
    {29, McodeAct::nothing, "", "couples feed and spindle for tapping", ""},
    {30, McodeAct::end, "ends the program", "ends the program", "ends the program"},
    {31, McodeAct::nothing, "", "chip conveyor forward", ""},
    {33, McodeAct::nothing, "", "chip conveyor stop", ""},
    {34, McodeAct::nothing, "", "coolant nozzle down", ""},
    {35, McodeAct::nothing, "", "coolant nozzle up", ""},
    {40, McodeAct::nothing, "", "gear range", ""},
    {41, McodeAct::nothing, "", "gear range", ""},
    {42, McodeAct::nothing, "", "gear range", ""},
    {43, McodeAct::nothing, "", "gear range", ""},
    {44, McodeAct::nothing, "", "gear range", ""},
    {45, McodeAct::nothing, "", "gear range", ""},
    {46, McodeAct::rejected, "", "jumps to another line", ""},
    {48, McodeAct::nothing, "allows overrides", "allows overrides", ""},
    {49, McodeAct::nothing, "forbids overrides", "forbids overrides", ""},
    {50, McodeAct::rejected, "feed override on or off", "changes the pallet", ""},
    {51, McodeAct::nothing, "spindle override on or off", "sets an output", ""},
    {52, McodeAct::nothing, "adaptive feed on or off", "sets an output", ""},
    {53, McodeAct::nothing, "feed stop input on or off", "sets an output", ""},
    {60, McodeAct::rejected, "changes the pallet", "changes the pallet", ""},
    {61, McodeAct::rejected, "names another tool as the one that is mounted", "clears an output", ""},
    {62, McodeAct::nothing, "sets an output", "clears an output", ""},
    {63, McodeAct::nothing, "clears an output", "clears an output", ""},
    {64, McodeAct::nothing, "sets an output", "clears an output", ""},
    {65, McodeAct::nothing, "clears an output", "clears an output", ""},
    {66, McodeAct::rejected, "waits for an input", "clears an output", ""},
    {67, McodeAct::nothing, "sets an analogue output", "clears an output", ""},
    {68, McodeAct::nothing, "sets an analogue output", "clears an output", ""},
    {70, McodeAct::nothing, "saves the modal state", "", ""},
    {71, McodeAct::nothing, "discards the saved modal state", "", ""},
    {72, McodeAct::rejected, "restores the saved modal state", "", ""},
    {73, McodeAct::nothing, "saves the modal state for a subprogram", "tool air blast on", ""},
    {74, McodeAct::nothing, "", "tool air blast off", ""},
    {76, McodeAct::nothing, "", "display off", ""},
    {77, McodeAct::nothing, "", "display on", ""},
    {80, McodeAct::nothing, "", "opens the door", ""},
    {81, McodeAct::nothing, "", "closes the door", ""},
    {82, McodeAct::rejected, "", "releases the tool", ""},
    {83, McodeAct::nothing, "", "air gun on", ""},
    {84, McodeAct::nothing, "", "air gun off", ""},
    {88, McodeAct::through_tool, "", "coolant through the tool on", ""},
    {89, McodeAct::through_tool_off, "", "coolant through the tool off", "calls a cycle after each block"},
    {90, McodeAct::rejected, "", "clamps the fixture", "rounds corners"},
    {91, McodeAct::rejected, "", "releases the fixture", "counts the block's positions from the machine's zero"},
    {92, McodeAct::rejected, "", "", "counts the block's positions from a position of the machine's builder"},
    {94, McodeAct::rejected, "", "", "reduces the rotary axes' positions to less than a turn"},
    {95, McodeAct::rejected, "", "waits for a time", ""},
    {96, McodeAct::rejected, "", "jumps where an input is not set, or calls a macro at an interrupt", ""},
    {97, McodeAct::rejected, "", "calls a subprogram within the program",
     "machines small steps of a contour another way"},
    {98, McodeAct::rejected, "calls a subprogram", "calls a subprogram", "machines open corners completely"},
    {99, McodeAct::end, "begins the main program again", "begins the main program again", "calls a cycle"},
    {103, McodeAct::rejected, "the user's own code", "", "reduces the feed of plunging"},
    {109, McodeAct::rejected, "the user's own code", "", "keeps the feed at the cutting edge"},
    {110, McodeAct::rejected, "the user's own code", "", "reduces the feed at inner corners"},
    {114, McodeAct::rejected, "the user's own code", "", "corrects positions for tilted axes"},
    {116, McodeAct::rejected, "the user's own code", "", "takes the feed of rotary axes in mm/min"},
    {118, McodeAct::rejected, "the user's own code", "", "adds the handwheel's motion"},
    {124, McodeAct::rejected, "the user's own code", "", "leaves points out"},
    {126, McodeAct::rejected, "the user's own code", "", "turns rotary axes the shorter way"},
    {128, McodeAct::tcp_on, "", "", "tool centre point on"},
    {129, McodeAct::tcp_off, "", "", "tool centre point off"},
    {130, McodeAct::rejected, "the user's own code", "", "counts positions in the frame that is not tilted"},
    {136, McodeAct::rejected, "the user's own code", "", "takes the feed per revolution"},
    {140, McodeAct::rejected, "the user's own code", "", "retracts the tool along its axis"},
    {144, McodeAct::rejected, "the user's own code", "", "adds the offsets of tilted axes"},
    {198, McodeAct::rejected, "the user's own code", "calls a subprogram of another file", ""},
    {428, McodeAct::tcp_on, "tool centre point on (switchable kinematics)", "", ""},
    {429, McodeAct::tcp_off, "tool centre point off (switchable kinematics)", "", ""},
    {430, McodeAct::rejected, "the user's own kinematics", "", ""},
}};
static_assert(std::ranges::adjacent_find(mcode_rows, std::ranges::greater_equal(), &Mcode::code) == mcode_rows.end(),
              "each code once, in order");
static_assert(std::ranges::none_of(mcode_rows,
                                   [](const Mcode& row) {
                                     return row.linuxcnc.empty() && row.fanuc_haas.empty() && row.heidenhain.empty();
                                   }),
              "each code is known on some machine");

}  // namespace

const Mcode* find_mcode(int code) {
  const auto* const found = std::ranges::lower_bound(mcode_rows, code, {}, &Mcode::code);
  return found != mcode_rows.end() && found->code == code ? found : nullptr;
}

const GcodeGroup* still_gcode(int code) {
  const auto* const found = std::ranges::find(still, code, &Still::code);
  return found == still.end() ? nullptr : &found->group;
}

const char* gcode_hint(int code) {
  switch (code) {
    case 510:
    case 511:
    case 1010:
    case 160:
    case 70:
    case 71:
      return "It would change what the words of positions mean";
    case 2540:
    case 544:
      return "It would move the program's frame by what the machine has measured. Let the CAM system write positions "
             "of "
             "the tip";
    case 650:
    case 660:
    case 661:
      return "It calls a macro with arguments. Let the CAM system write the moves that the macro would make";
    case 760:
      return "It bores with a shift of the spindle in Fanuc and Haas, and cuts a thread in LinuxCNC. Let the CAM "
             "system "
             "write straight moves";
    case 870:
      return "It bores from behind or waits for the operator, by the control. Let the CAM system write straight moves";
    default:
      break;
  }
  switch (code / 10) {
    case 2:
    case 3:
    case 5:
    case 6:
      return "Let the CAM system write curves as arcs G2, G3 or straight moves";
    case 12:
    case 13:
    case 47:
    case 150:
      return "Let the CAM system write pockets and engraving as straight moves and arcs";
    case 27:
    case 29:
      return "Where the machine's own positions lie in the part is not known here";
    case 31:
    case 36:
    case 37:
    case 38:
      return "It probes: what follows depends on what it finds";
    case 41:
    case 42:
      return "Let the CAM system write the path of the tool's tip";
    case 43:
      return "It would move the tip by the words that come with it";
    case 92:
      return "It would move the program's frame";
    case 95:
    case 96:
      return "Use G93 or G94, with a spindle speed in rpm";
    default:
      return "";
  }
}

}  // namespace robomill::program
