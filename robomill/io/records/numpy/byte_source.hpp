#pragma once
// Of the readers of this folder.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace robomill::io {

/// Bytes that are read from begin to end, of a file or out of an archive.
class ByteSource {
 public:
  ByteSource() = default;
  virtual ~ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// The next bytes; fewer at the end alone. @throws InvalidInput if they cannot be read or are damaged
  virtual std::size_t read(std::span<char> to) = 0;
  /// All that there are, by what the file says.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
};

/// A part of an open file.
class FileBytes : public ByteSource {
 public:
  /// @param file  open, outlives this; @param name  of it, for messages
  FileBytes(int file, std::uint64_t begin, std::uint64_t size, std::string name)
      : file_(file), at_(begin), left_(size), size_(size), name_(std::move(name)) {}
  std::size_t read(std::span<char> to) override;
  [[nodiscard]] std::uint64_t size() const override { return size_; }

 private:
  int file_ = -1;
  std::uint64_t at_ = 0, left_ = 0, size_ = 0;
  std::string name_;
};

}  // namespace robomill::io
