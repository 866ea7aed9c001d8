#pragma once
// Of the reader of NPZ.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "robomill/io/records/numpy/byte_source.hpp"
#include "robomill/io/system/descriptor.hpp"

namespace robomill::io {

/// A file within a ZIP archive.
struct ZipEntry {
  std::string name = {};
  int method = 0;  ///< 0 stored, 8 deflated
  bool is_encrypted = false;
  std::uint32_t crc = 0;
  std::uint64_t packed_bytes = 0, bytes = 0;
  std::uint64_t header_at = 0;  ///< where its own header begins
};

/// An archive by its directory, at the end; ZIP64 too. Nothing is unpacked before it is asked for.
/// Source: [PKWARE2022] APPNOTE.TXT
class ZipFile {
 public:
  /// @throws InvalidInput if it is missing, none, damaged, or in several parts
  explicit ZipFile(const std::filesystem::path& path);

  [[nodiscard]] const std::vector<ZipEntry>& entries() const { return entries_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Its bytes, unpacked as they are read; at the end its checksum is compared. Not longer than this.
  /// @throws InvalidInput if it is encrypted, packed otherwise, outside the archive, or says that it holds more than
  ///     can be packed into its bytes
  [[nodiscard]] std::unique_ptr<ByteSource> open(const ZipEntry& entry) const;

 private:
  void read_directory();
  [[nodiscard]] std::string bytes(std::uint64_t at, std::size_t count) const;

  std::string name_;
  Descriptor file_;
  std::uint64_t size_ = 0;
  std::vector<ZipEntry> entries_;
};

}  // namespace robomill::io
