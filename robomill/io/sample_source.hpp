#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"

// Method: robomill/io/README.md, "Sound and MAT"

namespace robomill::io {

/// Which columns of a recording are wanted, and what its numbers mean.
struct SampleColumns {
  std::vector<std::string> channels;  ///< names, or numbers from 1; at least one
  std::string followed = {};          ///< name of a column of text that SampleBlock::followed has; empty: none
  double followed_factor = 1.0;       ///< from its unit to SI
  int raw_columns = 0;                ///< of raw samples; 0: as many as are named, or the highest number
  double scale = 1.0;                 ///< unit per full scale of WAV and int16, per 1 of raw float32; finite, not 0
  /// What the recording must run at [Hz]; 0: what it says itself. Rejected where |own / this - 1| > 1e-3; for times in
  /// text, whose mean step counts, > 0.01.
  double sample_rate_hz = 0.0;

  /// @throws InvalidInput
  ROBOMILL_API void validate() const;
};

/// How bytes without an ending are to be read.
enum class RawFormat {
  automatic,  ///< of a file, by its ending; of a stream, csv where its first bytes are text, else float32
  float32,    ///< little-endian IEEE 754 single, columns interleaved; times SampleColumns::scale
  int16,      ///< little-endian two's complement, columns interleaved; scale / 32768 a count
  csv         ///< rows of numbers as text, with or without a header
};

/// Frames in a row.
struct SampleBlock {
  /// All channels interleaved; NaN where a row could not be read, infinite where raw samples are misaligned.
  std::vector<float> samples;
  /// The last number >= 0 of the followed column up to the end of the block, in SI; NaN: none
  double followed = std::numeric_limits<double>::quiet_NaN();
};

/// A recording read from its begin to its end. WAV, text and raw samples take the same memory whatever their length;
/// the others are held whole.
class ROBOMILL_API SampleSource {
 public:
  SampleSource() = default;
  virtual ~SampleSource() = default;
  SampleSource(const SampleSource&) = delete;
  SampleSource& operator=(const SampleSource&) = delete;

  /// The next frames, at most so many; false at the end, or when asked to stop. A pipe gives what is there.
  virtual bool next(std::size_t frames, SampleBlock& block) = 0;

  /// What it runs at [Hz]; 0 where it does not say.
  [[nodiscard]] double sample_rate_hz() const { return sample_rate_hz_; }
  /// Magnitude at which its converter clips, in the unit of the samples; 0: unknown.
  [[nodiscard]] double full_scale() const { return full_scale_; }
  /// What a reader must know: that a file was cut off, data sets skipped, units converted.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /// Rows of text that held something else than their numbers, and the line of the first.
  [[nodiscard]] std::uint64_t unreadable_rows() const { return unreadable_rows_; }
  [[nodiscard]] std::uint64_t first_unreadable_line() const { return first_unreadable_line_; }
  /// Frames of raw samples that do not begin at the first byte of a sample: a byte was lost, or the format is another.
  [[nodiscard]] std::uint64_t misaligned_frames() const { return misaligned_frames_; }

 protected:
  double sample_rate_hz_ = 0.0, full_scale_ = 0.0;
  std::vector<std::string> notes_;
  std::uint64_t unreadable_rows_ = 0, first_unreadable_line_ = 0, misaligned_frames_ = 0;
};

/// A file by its ending (.csv .txt .dat .asc .uff .unv .uf .mat .h5 .hdf5 .hdf .npy .npz .lvm .tdms .wav), or as
/// `format` says.
///
/// Text: as parse_table reads it, but one column may be followed, empty fields and "nan" are NaN, and rows that cannot
/// be read are frames of NaN that are counted. Names of channels stand for columns in their order where the recording
/// names none and has as many.
/// @param stop  becomes true when reading should end; outlives the source; may be null
/// @throws InvalidInput if it is missing, has no such columns, or runs at another rate than columns.sample_rate_hz
[[nodiscard]] ROBOMILL_API std::unique_ptr<SampleSource> open_samples(const std::filesystem::path& path,
                                                                      const SampleColumns& columns,
                                                                      RawFormat format = RawFormat::automatic,
                                                                      const std::atomic<bool>* stop = nullptr);

/// A recording whose channels are in several files of one rate, joined by time, or by rate and length. All of them are
/// held whole, WAV and text too. A channel is named as of one file, or "FILE:COLUMN" where several files have it.
/// @throws InvalidInput as open_samples of one, and naming two files that do not go together
[[nodiscard]] ROBOMILL_API std::unique_ptr<SampleSource> open_samples(const std::vector<std::filesystem::path>& files,
                                                                      const SampleColumns& columns);

/// Whether open_samples holds a file whole, by its ending and its beginning; false also of what is no recording.
[[nodiscard]] ROBOMILL_API bool is_held_whole(const std::filesystem::path& path);

/// Bytes from an open descriptor, standard input say, which stays open.
/// @param where  names it in messages
/// @throws InvalidInput if text has no such columns
[[nodiscard]] ROBOMILL_API std::unique_ptr<SampleSource> open_sample_stream(int descriptor, const std::string& where,
                                                                            const SampleColumns& columns,
                                                                            RawFormat format,
                                                                            const std::atomic<bool>* stop = nullptr);

/// Where the wanted channels stand among the columns of raw samples, which have no names.
/// @throws InvalidInput if they cannot be determined
[[nodiscard]] ROBOMILL_API std::vector<std::size_t> pick_channels(const SampleColumns& columns, std::size_t count,
                                                                  const std::string& where);

/// Writes float samples as WAV, whole or not at all.
/// @param samples  channels interleaved
/// @throws InvalidInput if the rate is no whole number of Hz or the place cannot be written
ROBOMILL_API void write_wav(const std::filesystem::path& path, const std::vector<float>& samples, int channels,
                            double sample_rate_hz);

}  // namespace robomill::io
