#pragma once
// Of the reader of TDMS.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/records/labview/tdms_format.hpp"

namespace robomill::io {

/// Where numbers of a channel stand in a chunk of raw data.
struct TdmsSource {
  const TdmsType* type = nullptr;
  std::uint64_t offset = 0;  ///< of the first, in the chunk
  std::uint64_t stride = 0;
  int bit = -1;          ///< of a digital line: which of its byte
  std::uint32_t id = 0;  ///< of a scaler of DAQmx: the scale that takes it
};

/// The samples of a channel in a segment.
struct TdmsRun {
  std::size_t object = 0;
  std::uint64_t a_chunk = 0;             ///< samples in a whole chunk
  std::uint64_t samples = 0;             ///< in all chunks, the last of which may not be whole
  std::vector<TdmsSource> sources = {};  ///< several of a channel of DAQmx that several converters make
};

/// A scaler of DAQmx as a raw data index has it.
struct TdmsScaler {
  const TdmsType* type = nullptr;
  std::uint32_t buffer = 0, byte = 0, id = 0;
  int bit = -1;
};

/// A file, a group or a channel, as far as segments were read.
struct TdmsObject {
  std::string path = {}, group = {}, name = {};  ///< without group and name: the file; without name: a group
  TdmsProperties properties = {};                ///< those that say what numbers mean
  const TdmsType* type = nullptr;                ///< of its raw data; null: none yet, or of DAQmx
  bool has_index = false, is_daqmx = false;
  bool is_listed = false;               ///< among the objects of this segment …
  bool has_data = false;                ///< … with raw data
  std::uint64_t values = 0, bytes = 0;  ///< in a chunk
  std::vector<TdmsScaler> scalers = {};
  std::vector<std::uint64_t> widths = {};  ///< of the rows of each buffer of DAQmx [bytes]
  std::uint64_t samples = 0;               ///< in the segments so far
  bool restarted = false;                  ///< its start was set again behind samples
};

/// The segments of a TDMS file, one after another.
class TdmsSegments {
 public:
  /// @param bytes  the whole file; outlives this
  /// @throws InvalidInput if it is none
  TdmsSegments(std::string_view bytes, std::string file);

  /// False at the end. @throws InvalidInput naming the place, if the segment is damaged or has what is not read
  bool next();

  /// Of this segment; empty where it has no raw data.
  [[nodiscard]] const std::vector<TdmsRun>& runs() const { return has_raw_ ? runs_ : none_; }
  /// Where the samples that a source has in a chunk begin in the file, one a stride.
  [[nodiscard]] std::size_t begin_of(const TdmsSource& source, std::uint64_t chunk) const;
  [[nodiscard]] bool big_endian() const { return big_endian_; }
  /// Those that the segments so far name.
  [[nodiscard]] const std::vector<TdmsObject>& objects() const { return objects_; }
  /// Null where no object has the path.
  [[nodiscard]] const TdmsObject* object(std::string_view path) const;
  /// That the file ends within its last segment, say.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  /// Of the raw data of a segment, until other objects come.
  struct Layout {
    std::uint64_t chunk_bytes = 0;
    std::uint64_t row_bytes = 0;    ///< where the raw data is rows from begin to end; 0: it is chunks
    std::uint64_t least_bytes = 0;  ///< that hold a sample of each channel
    bool equal = true;              ///< each channel has as many samples in a chunk
    std::uint32_t flags = 0;        ///< of the segment that it was made for
  };
  [[nodiscard]] InvalidInput damaged(const std::string& what) const;
  [[nodiscard]] std::uint64_t number(std::size_t width);
  [[nodiscard]] std::string_view text();
  bool read_lead_in();
  void read_metadata();
  void read_object();
  void read_index(TdmsObject& object, std::uint32_t header);
  void read_scalers(TdmsObject& object, bool digital);
  void read_property(TdmsObject& object);
  void lay_out();
  void lay_out_plain();
  void lay_out_daqmx();
  [[nodiscard]] std::vector<std::uint64_t> buffers_of(const TdmsObject& first) const;
  void count_samples(std::uint64_t raw_bytes);
  void note_end(const std::string& what);

  std::string_view bytes_;
  std::string file_;
  std::size_t begin_ = 0, following_ = 0;  ///< of this segment and the next
  std::size_t at_ = 0, end_ = 0;           ///< of what is read next, and of what may be read
  std::size_t raw_ = 0;                    ///< begin of the raw data
  std::uint64_t raw_bytes_ = 0;
  std::uint32_t flags_ = 0;
  bool big_endian_ = false, has_raw_ = false, is_laid_out_ = false;
  std::vector<TdmsObject> objects_;
  std::map<std::string, std::size_t, std::less<>> places_;
  std::vector<std::size_t> active_;  ///< objects in the order of their raw data
  Layout layout_;
  std::uint64_t samples_ = 0, work_ = 0;  ///< so far, to bound what a small file can ask for
  const std::vector<TdmsRun> none_ = {};
  std::vector<TdmsRun> runs_;
  std::vector<std::string> notes_;
};

}  // namespace robomill::io
