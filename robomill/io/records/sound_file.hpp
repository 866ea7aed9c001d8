#pragma once
#include <sndfile.h>

#include <filesystem>
#include <memory>
#include <string>

#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {

using Sound = std::unique_ptr<SNDFILE, decltype(&sf_close)>;

/// A sound file that is open to be read. The library gets a descriptor and no name, so that it can open nothing else.
struct SoundFile {
  Descriptor file;  ///< outlives the library's use of it
  Sound sound{nullptr, &sf_close};
  SF_INFO info{};
  std::filesystem::path path = {};
  std::string note = {};  ///< that the file is shorter than its header says; empty: it is not
};

/// @throws InvalidInput if there is none, it has no channel or no sample rate, or states no samples and has some
[[nodiscard]] SoundFile open_sound(const std::filesystem::path& path);
/// After fewer samples than were asked for. @throws InvalidInput if the system could not read on: that is no end
void require_read(const SoundFile& file);

}  // namespace robomill::io
