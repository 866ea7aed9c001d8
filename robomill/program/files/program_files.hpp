#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/program/machine.hpp"
#include "robomill/program/program.hpp"

// Method: robomill/program/README.md, "Files"

namespace robomill::program {

/// How a program's file is written.
enum class ProgramFormat {
  gcode,  ///< words of address letter and number, read as LinuxCNC does
  apt,    ///< cutter location statements: GOTO, GODLTA, FROM, RAPID, FEDRAT, …
  csv     ///< a row a pose: x_mm, y_mm, z_mm, i, j, k, feed_mm_per_min
};

/// .apt .cls .cl .ncl .aptsource, .csv; anything else is G-code. Case does not matter.
[[nodiscard]] ROBOMILL_API ProgramFormat program_format_of(const std::filesystem::path& path);

/// "xyzac-trt", "xyzbc-trt", "xyzac-head", "xyzbc-head".
/// @throws InvalidInput naming the field program.machine
[[nodiscard]] ROBOMILL_API Machine parse_machine(std::string_view name);

/// How the tool's axis goes where the words A, B and C turn.
enum class Rotary {
  machine,      ///< as a machine goes: each of them evenly in time, as far and in the direction that the words say
  great_circle  ///< the shortest way between the ends of a straight move; at feed, words that turn C by >= 180° are
                ///< rejected where the machine would leave that way by more than axis_tolerance_rad
};

/// "machine" or "great-circle". @throws InvalidInput naming the field program.rotary
[[nodiscard]] ROBOMILL_API Rotary parse_rotary(std::string_view name);

/// The offsets of a work frame of G-code, as the control's table has them. Its axes are those of the machine.
struct ROBOMILL_API WorkFrame {
  std::string code = {};  ///< "G55", "G59.1", "G54.1 P3", "G154 P2", "G112"; required
  /// Its zero in machine coordinates; required, |x|, |y|, |z| <= 1000.
  Eigen::Vector3d origin_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// The number of the work frame that a code names: the same for two codes of one frame, as G110 and G154 P1.
/// @throws InvalidInput naming the field program.frames.code
[[nodiscard]] ROBOMILL_API int parse_work_frame(std::string_view code);

/// Of a program that cuts with several tools, what is read.
struct ROBOMILL_API ToolChoice {
  std::optional<int> number = {};  ///< that T, LOADTL or LOAD/TOOL gives
  std::string name = {};           ///< of TOOL PATH, where no number is given; not both
  /// Which of the tool's parts, from 1 on: its moves between those of other tools. None: it has one part.
  std::optional<int> part = {};
  [[nodiscard]] bool given() const { return number || !name.empty(); }
  /// The tool, whatever its part.
  [[nodiscard]] bool is(std::optional<int> other_number, const std::string& other_name) const {
    return number ? number == other_number : !other_number && name == other_name;
  }
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// How to read a program.
struct ROBOMILL_API ProgramReading {
  std::optional<Machine> machine = {};  ///< what A, B and C mean; a program without them needs none
  Rotary rotary = Rotary::machine;
  double chord_tolerance_m = 1e-6;  ///< in [1e-9, 1); |chord - arc| <= tolerance at the same time
  /// In [1e-9, 1) (default 0.001°); angle of a part's great circle to the axis of a machine's move <= tolerance at the
  /// same time.
  double axis_tolerance_rad = 1.7453292519943296e-5;
  std::optional<ProgramFormat> format = {};  ///< none: by the file's ending
  /// Only what this tool moves is read, modes follow through the parts of the others; none: a program that cuts with
  /// several tools is rejected.
  ToolChoice tool = {};
  /// Work frames of G-code, each once, as if the control's table had these offsets when the program begins: W is the
  /// frame in which the program begins, and positions in another one are moved by the difference of both offsets. A
  /// program that uses several frames needs all of them, from here or from its own G10 L2, which sets the table when it
  /// comes (listed as assumed where the offsets differ). Frames that it does not use do not count.
  std::vector<WorkFrame> frames = {};
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// An NC program read block by block from its file, in memory that does not grow with it.
///
/// Every format: blocks that move nothing are left out; what is not carried out stands in `skipped`, with its line; the
/// first position that is complete makes the start. An axis whose length is within 1e-3 of 1 is made a unit vector,
/// with a note where it was off by more than 1e-6.
///
/// G-code (.ngc .nc .gcode): moves G0 and G1, arcs G2 and G3, and dwells G4, in mm or inches (G21, G20), absolute or
/// incremental (G90, G91), with F in mm/min (G94; deg/min where only the axis moves) or as the inverse of the move's
/// minutes (G93). The axis comes from A, B and C in degrees, each turning evenly over its move, or from I, J and K on
/// lines of straight moves, its unit vector. A program that says nothing else is in mm, absolute, G94, G17, its axis
/// along z.
///
/// Arcs lie in the plane G17, G18 or G19 and rise along its normal; I, J and K are their centre, counted from the begin
/// (G91.1) or not (G90.1), or R their radius, negative beyond half a turn; P is the number of turns begun. They become
/// equal chords, whose ends lie on the arc; A, B and C turn evenly with it. The radius at an arc's end may differ from
/// that at its begin by 5 um (inches: 12.7 um) or a thousandth of it, at most by 0.5 mm [LinuxCncGcode].
/// The time of a dwell is P in seconds.
///
/// The first line after which X, Y and Z are all known makes the start. Spindle and coolant stand with each block, M0
/// and M1 as dwells with `operator_stop`; harmless M codes, tools, offsets' numbers and G codes that move nothing stand
/// in `skipped`. Drilling cycles and calls of subprograms become the moves that they make. G52 and G92 move the frame,
/// other work frames are read where ProgramReading::frames or G10 L2 gives them. After G28, G30 and G53 the position is
/// not known until a rapid gives it. Rejected are feeds that are missing or not above 0, two G codes of one group,
/// words of axes that the machine does not have, arcs whose radius does not fit, codes that would move the tool or its
/// frame in ways that are not read (splines, compensation, macros), M codes not known to be harmless,
/// and moves at feed after another tool, another length, a work frame that is not given or the end of the tool centre
/// point.
///
/// Several tools: of the tool that the reading chooses, the first complete position after its change makes the start.
/// Parts of other tools stand in `skipped` with their first lines. A chosen tool or part that the program does not
/// have is rejected, and a tool that moves again after another one has moved, unless one of its parts is chosen.
///
/// APT/CL (.apt .cls .cl .ncl .aptsource): GOTO, GODLTA, FROM; RAPID holds for one move; FEDRAT a minute or a
/// revolution; UNITS (mm unless said), SPINDL, DELAY in seconds. Arcs (CIRCLE, MOVARC, TLON,GOFWD) become chords, CYCLE
/// the moves of its holes. Positions behind another MSYS are moved into the first one; CSYS under TRNTYP/WORLD, CUTCOM
/// and unknown statements are listed, others that move the tool or its frame rejected.
///
/// CSV: columns x_mm, y_mm, z_mm, i, j, k, feed_mm_per_min in any order; the first row is the start, and the feed of a
/// row that of the move to it.
///
/// A feed counts the tip's way, and degrees where the axis alone turns.
class ROBOMILL_API ProgramFile final : public Source {
 public:
  /// @throws InvalidInput if the options are invalid, work frames are given and the format is not G-code, the file
  ///     cannot be read, or as next() up to the start
  explicit ProgramFile(const std::filesystem::path& path, const ProgramReading& reading = {});
  ~ProgramFile() override;
  ProgramFile(const ProgramFile&) = delete;
  ProgramFile& operator=(const ProgramFile&) = delete;
  ProgramFile(ProgramFile&&) = delete;
  ProgramFile& operator=(ProgramFile&&) = delete;

  [[nodiscard]] const Pose& start() const override;
  /// @throws InvalidInput with file, line, word and value: what cannot be read, feeds that are missing or not above 0,
  ///     axes that are no unit vectors or turn by half a circle in one move, and what would move the tool or its frame
  ///     in ways that are not read
  bool next(Block& out) override;
  /// @throws InvalidInput if the file is a pipe
  void rewind() override;

  /// Of what was left out the first 500 are kept.
  [[nodiscard]] Remarks remarks() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

[[nodiscard]] ROBOMILL_API std::unique_ptr<ProgramFile> open_program(const std::filesystem::path& path,
                                                                     const ProgramReading& reading = {});

/// The whole program, with all that was left out. @throws InvalidInput as ProgramFile
[[nodiscard]] ROBOMILL_API Program read_program(const std::filesystem::path& path, const ProgramReading& reading = {});

/// The same of a text in memory.
/// @param name  as of a file, for errors; its ending is the format's where the reading names none
[[nodiscard]] ROBOMILL_API Program read_program_text(const std::string& text, const std::filesystem::path& name,
                                                     const ProgramReading& reading = {});

}  // namespace robomill::program
