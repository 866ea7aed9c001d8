#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/sample_parts.hpp"

namespace robomill::io {
namespace {

using Sound = std::unique_ptr<SNDFILE, decltype(&sf_close)>;

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
  WavSource(const std::filesystem::path& path, const SampleColumns& columns) : scale_(columns.scale) {
    (void)open_file(path);  // says what is wrong with a missing one
    SF_INFO info{};
    sound_ = Sound(sf_open(path.c_str(), SFM_READ, &info), &sf_close);
    if (!sound_) throw InvalidInput(path.string(), std::string("is no sound file: ") + sf_strerror(nullptr));
    if (info.channels < 1 || info.samplerate < 1) throw InvalidInput(path.string(), "has no channel or no sample rate");
    columns_ = static_cast<std::size_t>(info.channels);
    sample_rate_hz_ = info.samplerate;
    full_scale_ = std::abs(scale_) * full_scale_of(info.format);
    check_rate(sample_rate_hz_, columns.sample_rate_hz, 1e-3, path.string());
    pick_ = pick_columns(columns, {}, columns_, path.string());
  }

  bool next(std::size_t frames, SampleBlock& block) override {
    block.samples.clear();
    buffer_.resize(frames * columns_);
    const sf_count_t count = sf_readf_float(sound_.get(), buffer_.data(), static_cast<sf_count_t>(frames));
    for (std::size_t frame = 0; frame < static_cast<std::size_t>(std::max<sf_count_t>(count, 0)); ++frame) {
      for (const std::size_t column : pick_) {
        block.samples.push_back(static_cast<float>(scale_ * static_cast<double>(buffer_[frame * columns_ + column])));
      }
    }
    return !block.samples.empty();
  }

 private:
  Sound sound_{nullptr, &sf_close};
  double scale_ = 1.0;
  std::size_t columns_ = 0;
  std::vector<std::size_t> pick_;
  std::vector<float> buffer_;
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
  SF_INFO info{};
  info.samplerate = static_cast<int>(sample_rate_hz);
  info.channels = channels;
  info.format = SF_FORMAT_WAV | SF_FORMAT_FLOAT;
  {
    const Sound sound(sf_open(pending.temporary().c_str(), SFM_WRITE, &info), &sf_close);
    if (!sound) throw InvalidInput(path.string(), std::string("cannot be written: ") + sf_strerror(nullptr));
    // Its peak chunk holds the time of writing: the same samples are to give the same bytes.
    sf_command(sound.get(), SFC_SET_ADD_PEAK_CHUNK, nullptr, SF_FALSE);
    const auto frames = static_cast<sf_count_t>(samples.size() / static_cast<std::size_t>(channels));
    if (sf_writef_float(sound.get(), samples.data(), frames) != frames) {
      throw InvalidInput(path.string(), std::string("cannot be written: ") + sf_strerror(sound.get()));
    }
  }
  pending.commit();
}

}  // namespace robomill::io
