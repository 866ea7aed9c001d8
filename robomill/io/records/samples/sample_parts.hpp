#pragma once
// What the sources of samples share; not for other folders.
#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/io/sample_source.hpp"

namespace robomill::io {

/// Bytes of a descriptor as they come. A second thread may ask it to stop while it waits.
class ByteReader {
 public:
  /// @param owned  close it at the end
  /// @param where  whatever names it in errors
  ByteReader(int descriptor, bool owned, const std::atomic<bool>* stop, std::string where)
      : descriptor_(descriptor), owned_(owned), stop_(stop), where_(std::move(where)) {}
  ~ByteReader();
  ByteReader(const ByteReader&) = delete;
  ByteReader& operator=(const ByteReader&) = delete;

  /// What has come and was not consumed; waits for more while that is less than `least`. Shorter only at the end.
  /// @throws InvalidInput, as line() does, if the system cannot read on: that is no end
  [[nodiscard]] std::string_view wait(std::size_t least);
  /// What is there without waiting.
  [[nodiscard]] std::string_view here() const { return std::string_view(bytes_).substr(begin_); }
  void consume(std::size_t count) { begin_ += count; }
  /// The next line without its ending; none at the end. What is beyond 1 MiB of a line is left out.
  [[nodiscard]] std::optional<std::string_view> line();
  /// Whether a line, or the end, can be had without waiting.
  [[nodiscard]] bool line_here() const;

 private:
  /// False at the end.
  bool fill();

  int descriptor_ = -1;
  bool owned_ = false, ended_ = false;
  const std::atomic<bool>* stop_ = nullptr;
  std::string where_, bytes_;
  std::size_t begin_ = 0;
};

/// Where the wanted channels stand among the columns.
/// @param left_out  what of the recording is no column, each with the reason
/// @throws InvalidInput naming the columns that are there
[[nodiscard]] std::vector<std::size_t> pick_columns(const SampleColumns& wanted, const std::vector<std::string>& names,
                                                    std::size_t count, const std::string& where,
                                                    const std::vector<std::string>& left_out = {});
/// @throws InvalidInput where both rates are known and differ by more than `tolerance` of them
void check_rate(double own_hz, double wanted_hz, double tolerance, const std::string& where);

[[nodiscard]] std::unique_ptr<SampleSource> text_source(std::unique_ptr<ByteReader> bytes, const SampleColumns& columns,
                                                        const std::string& where, bool is_file);
[[nodiscard]] std::unique_ptr<SampleSource> raw_source(std::unique_ptr<ByteReader> bytes, const SampleColumns& columns,
                                                       const std::string& where, bool is_int16);
[[nodiscard]] std::unique_ptr<SampleSource> wav_source(const std::filesystem::path& path, const SampleColumns& columns);
/// Held whole; several files are joined (io/joined_records.hpp).
[[nodiscard]] std::unique_ptr<SampleSource> record_source(const std::vector<std::filesystem::path>& files,
                                                          const SampleColumns& columns);

}  // namespace robomill::io
