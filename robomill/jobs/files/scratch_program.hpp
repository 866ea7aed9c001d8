#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "robomill/io/file.hpp"

namespace robomill::jobs {

/// A program's text as a file, for readers that read files, as long as this lives.
class ScratchProgram {
 public:
  /// @param folder  empty: io::scratch_folder
  /// @param name    whose ending is the program's format
  /// @throws InvalidInput if it cannot be written
  ScratchProgram(const std::filesystem::path& folder, const std::string& name, std::string_view text);
  [[nodiscard]] const std::filesystem::path& path() const { return file_.temporary(); }

 private:
  io::PendingFile file_;
};

}  // namespace robomill::jobs
