#pragma once
#include <filesystem>
#include <memory>

#include "robomill/base/error.hpp"
#include "robomill/base/export.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/process/cut.hpp"

// Method: robomill/process/README.md, "Files"

namespace robomill::io {
class TomlFile;
}

namespace robomill::process {

/// For which job the file is read: what the others need may be missing.
enum class ForcesJob {
  identification,  ///< one revolution of one cut whose coefficients are sought: they may be missing
  revolution,      ///< one revolution of one cut: needs depths, feed, speed and direction, and the posture of a robot
  program          ///< block by block along a program: speed, feed and engagement come from program and workpiece
};

/// forces.toml: a cut, and the document that it was read from.
struct ForcesFile : Cut {
  std::filesystem::path cell = {};  ///< robot.cell or job.cell, or the document where [robot] is the arm; else empty
  /// Calls f; an InvalidInput about a member that this file gave comes out in its words.
  template <class F>
  auto located(F&& f) const {
    try {
      return f();
    } catch (const InvalidInput& error) {
      throw in_its_words(error);
    }
  }
  [[nodiscard]] ROBOMILL_API InvalidInput in_its_words(const InvalidInput& error) const;
  ForcesJob job = ForcesJob::revolution;              ///< that it was read for
  std::shared_ptr<const io::TomlFile> document = {};  ///< for errors in its words; empty where built in memory
};

/// The program that a document of a job names; empty: none.
[[nodiscard]] ROBOMILL_API std::filesystem::path program_of_job(const io::TomlSource& source);

/// The files of modes and coefficients that it names are read too.
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API ForcesFile read_forces(const io::TomlSource& source, ForcesJob job = ForcesJob::revolution);

}  // namespace robomill::process
