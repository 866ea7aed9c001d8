#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/samples/sample_parts.hpp"
#include "robomill/io/records/sound_file.hpp"

namespace robomill::io {
namespace {

/// The largest magnitude that both signs of the format have, of full scale 1; 0 for floats, which do not clip.
double full_scale_of(int format) {
  switch (format & SF_FORMAT_SUBMASK) {
    case SF_FORMAT_PCM_S8:
    case SF_FORMAT_PCM_U8:
      return 127.0 / 128.0;
    case SF_FORMAT_PCM_16:
      return 32767.0 / 32768.0;
    case SF_FORMAT_PCM_24:
      return 8388607.0 / 8388608.0;
    case SF_FORMAT_PCM_32:
      return 2147483647.0 / 2147483648.0;
    default:
      return 0.0;
  }
}

class WavSource : public SampleSource {
 public:
  WavSource(const std::filesystem::path& path, const SampleColumns& columns)
      : file_(open_sound(path)), scale_(columns.scale), columns_(static_cast<std::size_t>(file_.info.channels)) {
    if (!file_.note.empty()) notes_.push_back(file_.note);
    sample_rate_hz_ = file_.info.samplerate;
    full_scale_ = std::abs(scale_) * full_scale_of(file_.info.format);
    check_rate(sample_rate_hz_, columns.sample_rate_hz, 1e-3, path.string());
    pick_ = pick_columns(columns, {}, columns_, path.string());
  }

  bool next(std::size_t frames, SampleBlock& block) override {
    block.samples.clear();
    buffer_.resize(frames * columns_);
    const sf_count_t count = sf_readf_float(file_.sound.get(), buffer_.data(), static_cast<sf_count_t>(frames));
    if (count < static_cast<sf_count_t>(frames)) require_read(file_);
    for (std::size_t frame = 0; frame < static_cast<std::size_t>(std::max<sf_count_t>(count, 0)); ++frame) {
      for (const std::size_t column : pick_) {
        block.samples.push_back(static_cast<float>(scale_ * static_cast<double>(buffer_[frame * columns_ + column])));
      }
    }
    return !block.samples.empty();
  }

 private:
  SoundFile file_;
  double scale_ = 1.0;
  std::size_t columns_ = 0;
  std::vector<std::size_t> pick_;
  std::vector<float> buffer_;
};

/// A PendingFile as the library sees it.
class VirtualFile {
 public:
  explicit VirtualFile(PendingFile& file) : file_(&file) {}
  [[nodiscard]] Sound open(int mode, SF_INFO& info) { return {sf_open_virtual(&calls_, mode, &info, this), &sf_close}; }

 private:
  static VirtualFile& of(void* user) { return *static_cast<VirtualFile*>(user); }
  static sf_count_t length(void* user) { return static_cast<sf_count_t>(of(user).file_->size()); }
  static sf_count_t tell(void* user) { return static_cast<sf_count_t>(of(user).at_); }
  static sf_count_t seek(sf_count_t offset, int whence, void* user) {
    const sf_count_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? tell(user) : length(user);
    of(user).at_ = static_cast<std::uint64_t>(std::max<sf_count_t>(0, from + offset));
    return tell(user);
  }
  static sf_count_t read(void* to, sf_count_t count, void* user) {
    const std::span<char> bytes(static_cast<char*>(to), static_cast<std::size_t>(count));
    const std::size_t got = of(user).file_->read_at(of(user).at_, bytes);
    of(user).at_ += got;
    return static_cast<sf_count_t>(got);
  }
  static sf_count_t write(const void* from, sf_count_t count, void* user) {
    const std::string_view bytes(static_cast<const char*>(from), static_cast<std::size_t>(count));
    if (!of(user).file_->write_at(of(user).at_, bytes)) return 0;
    of(user).at_ += bytes.size();
    return count;
  }

  PendingFile* file_;
  std::uint64_t at_ = 0;
  SF_VIRTUAL_IO calls_{length, seek, read, write, tell};
};

}  // namespace

std::unique_ptr<SampleSource> wav_source(const std::filesystem::path& path, const SampleColumns& columns) {
  return std::make_unique<WavSource>(path, columns);
}

void write_wav(const std::filesystem::path& path, const std::vector<float>& samples, int channels,
               double sample_rate_hz) {
  if (!(sample_rate_hz >= 1.0 && sample_rate_hz <= 1e9) || sample_rate_hz != std::round(sample_rate_hz)) {
    throw InvalidInput("sample_rate_hz", sample_rate_hz, "Hz", "must be a whole number for .wav");
  }
  PendingFile pending(path);
  const auto frames = static_cast<sf_count_t>(samples.size() / static_cast<std::size_t>(channels));
  SF_INFO info{};
  info.samplerate = static_cast<int>(sample_rate_hz);
  info.channels = channels;
  info.format = SF_FORMAT_WAV | SF_FORMAT_FLOAT;
  const auto require = [&](bool good, SNDFILE* sound) {
    if (pending.failed()) pending.prepare();  // says why
    if (!good) throw InvalidInput(path.string(), std::string("cannot be written: ") + sf_strerror(sound));
  };
  {
    VirtualFile target(pending);
    Sound sound = target.open(SFM_WRITE, info);
    require(sound != nullptr, nullptr);
    // Its peak chunk holds the time of writing: the same samples are to give the same bytes.
    sf_command(sound.get(), SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
    require(sf_writef_float(sound.get(), samples.data(), frames) == frames, sound.get());
    require(sf_close(sound.release()) == 0, nullptr);
  }
  SF_INFO written{};
  VirtualFile source(pending);
  const Sound sound = source.open(SFM_READ, written);
  require(sound != nullptr && written.frames == frames && written.channels == channels &&
              written.samplerate == info.samplerate,
          sound.get());
  pending.commit();
}

}  // namespace robomill::io
