#include "robomill/jobs/files/scratch_program.hpp"

#include "robomill/io/confinement.hpp"

namespace robomill::jobs {

ScratchProgram::ScratchProgram(const std::filesystem::path& folder, const std::string& name, std::string_view text)
    : file_((folder.empty() ? io::scratch_folder() : folder) / name) {
  io::write_file(file_.temporary(), text);
}

}  // namespace robomill::jobs
