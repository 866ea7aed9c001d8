#include "robomill/io/records/numpy/zip.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/byte_order.hpp"
#include "robomill/io/file.hpp"

namespace robomill::io {
namespace {

constexpr std::uint32_t end_mark = 0x06054b50, entry_mark = 0x02014b50, header_mark = 0x04034b50;
constexpr std::uint32_t end_64_mark = 0x06064b50, locator_64_mark = 0x07064b50;
constexpr std::size_t end_bytes = 22, entry_bytes = 46, own_header_bytes = 30, locator_64_bytes = 20, end_64_bytes = 56;
constexpr std::uint64_t longest_directory = std::uint64_t{1} << 26, most_entries = 100000;
constexpr std::uint32_t in_64 = 0xFFFFFFFF;
constexpr const char* damaged_zip = "is a damaged ZIP archive, or one that was cut off";

std::uint64_t little(std::string_view bytes, std::size_t at, std::size_t width) {
  return number_at(bytes, at, width, false);
}

/// Bytes of an entry, whose checksum is compared at their end.
class ZipBytes : public ByteSource {
 public:
  ZipBytes(std::unique_ptr<ByteSource> packed, const ZipEntry& entry, std::string where)
      : packed_(std::move(packed)), entry_(entry), where_(std::move(where)) {
    if (entry_.method == 0) return;
    is_open_ = ::inflateInit2(&stream_, -MAX_WBITS) == Z_OK;
    if (!is_open_) throw InvalidInput(where_, "cannot be unpacked", "Is there enough memory?");
    block_.resize(std::size_t{1} << 16);
  }
  ~ZipBytes() override {
    if (is_open_) ::inflateEnd(&stream_);
  }
  ZipBytes(const ZipBytes&) = delete;
  ZipBytes& operator=(const ZipBytes&) = delete;

  std::size_t read(std::span<char> to) override {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(to.size(), entry_.bytes - read_));
    const std::size_t got = entry_.method == 0 ? packed_->read(to.first(wanted)) : inflate(to.first(wanted));
    if (got < wanted) throw InvalidInput(where_, "ends before the bytes that its archive states", "Was it cut off?");
    crc_ = ::crc32(crc_, reinterpret_cast<const Bytef*>(to.data()), static_cast<uInt>(got));
    read_ += got;
    if (read_ == entry_.bytes && got > 0 && crc_ != entry_.crc) {
      throw InvalidInput(where_, "is damaged: its checksum is another", "Copy or save the file anew");
    }
    return got;
  }
  [[nodiscard]] std::uint64_t size() const override { return entry_.bytes; }

 private:
  std::size_t inflate(std::span<char> to) {
    stream_.next_out = reinterpret_cast<Bytef*>(to.data());
    stream_.avail_out = static_cast<uInt>(to.size());
    while (stream_.avail_out > 0 && !ended_) {
      if (stream_.avail_in == 0) {
        stream_.avail_in = static_cast<uInt>(packed_->read(block_));
        stream_.next_in = reinterpret_cast<Bytef*>(block_.data());
      }
      const int result = ::inflate(&stream_, Z_NO_FLUSH);
      ended_ = result == Z_STREAM_END;
      if (!ended_ && result != Z_OK) break;
    }
    return to.size() - stream_.avail_out;
  }

  std::unique_ptr<ByteSource> packed_;
  ZipEntry entry_;
  std::string where_, block_;
  z_stream stream_ = {};
  bool is_open_ = false, ended_ = false;
  uLong crc_ = 0;
  std::uint64_t read_ = 0;
};

/// What stands in the extra fields where 32 bits are too few.
void take_64(std::string_view extra, ZipEntry& entry) {
  while (extra.size() >= 4) {
    const std::uint64_t id = little(extra, 0, 2);
    const auto length = static_cast<std::size_t>(little(extra, 2, 2));
    std::string_view field = extra.substr(4, length);
    extra.remove_prefix(std::min(extra.size(), 4 + length));
    if (id != 1) continue;
    for (std::uint64_t* value : {&entry.bytes, &entry.packed_bytes, &entry.header_at}) {
      if (*value != in_64 || field.size() < 8) continue;
      *value = little(field, 0, 8);
      field.remove_prefix(8);
    }
  }
}

}  // namespace

ZipFile::ZipFile(const std::filesystem::path& path) : name_(path.string()) {
  (void)open_file(path);  // says what is wrong with a missing one
  int error = 0;
  file_ = open_descriptor(path.c_str(), O_RDONLY, error);
  if (error != 0) throw InvalidInput(name_, "cannot be read", error_text(error));
  struct stat status = {};
  if (::fstat(file_.get(), &status) != 0 || status.st_size <= 0) throw InvalidInput(name_, damaged_zip);
  size_ = static_cast<std::uint64_t>(status.st_size);
  read_directory();
}

std::string ZipFile::bytes(std::uint64_t at, std::size_t count) const {
  std::string out(count, '\0');
  std::size_t got = 0;
  if (const int error = read_all_at(file_.get(), out, at, got); error != 0) {
    throw InvalidInput(name_, "cannot be read to its end", error_text(error));
  }
  if (got < count) throw InvalidInput(name_, damaged_zip);
  return out;
}

void ZipFile::read_directory() {
  constexpr std::uint64_t longest_end = end_bytes + 65535;
  const std::uint64_t tail_at = size_ - std::min(size_, longest_end + locator_64_bytes);
  const std::string tail = bytes(tail_at, static_cast<std::size_t>(size_ - tail_at));
  std::size_t end = tail.size() < end_bytes ? std::string::npos : tail.size() - end_bytes;
  while (end != std::string::npos && little(tail, end, 4) != end_mark) end = end == 0 ? std::string::npos : end - 1;
  if (end == std::string::npos) throw InvalidInput(name_, damaged_zip, "Was it saved by numpy.savez?");
  std::uint64_t count = little(tail, end + 10, 2), length = little(tail, end + 12, 4), at = little(tail, end + 16, 4);
  if (little(tail, end + 4, 2) != 0 && little(tail, end + 4, 2) != 0xFFFF) {
    throw InvalidInput(name_, "is one of several parts of a ZIP archive");
  }
  if (end >= locator_64_bytes && little(tail, end - locator_64_bytes, 4) == locator_64_mark) {
    const std::uint64_t end_64 = little(tail, end - locator_64_bytes + 8, 8);
    if (end_64 > size_ || size_ - end_64 < end_64_bytes) throw InvalidInput(name_, damaged_zip);
    const std::string last = bytes(end_64, end_64_bytes);
    if (little(last, 0, 4) != end_64_mark) throw InvalidInput(name_, damaged_zip);
    count = little(last, 32, 8);
    length = little(last, 40, 8);
    at = little(last, 48, 8);
  }
  if (at > size_ || length > size_ - at || length > longest_directory || count > most_entries) {
    throw InvalidInput(name_, damaged_zip);
  }
  const std::string directory = bytes(at, static_cast<std::size_t>(length));
  std::string_view rest = directory;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (rest.size() < entry_bytes || little(rest, 0, 4) != entry_mark) throw InvalidInput(name_, damaged_zip);
    const auto name = static_cast<std::size_t>(little(rest, 28, 2)),
               extra = static_cast<std::size_t>(little(rest, 30, 2));
    const std::size_t all = entry_bytes + name + extra + static_cast<std::size_t>(little(rest, 32, 2));
    if (all > rest.size()) throw InvalidInput(name_, damaged_zip);
    ZipEntry entry{.name = std::string(rest.substr(entry_bytes, name)),
                   .method = static_cast<int>(little(rest, 10, 2)),
                   .is_encrypted = (little(rest, 8, 2) & 1) != 0,
                   .crc = static_cast<std::uint32_t>(little(rest, 16, 4)),
                   .packed_bytes = little(rest, 20, 4),
                   .bytes = little(rest, 24, 4),
                   .header_at = little(rest, 42, 4)};
    take_64(rest.substr(entry_bytes + name, extra), entry);
    entries_.push_back(std::move(entry));
    rest.remove_prefix(all);
  }
}

std::unique_ptr<ByteSource> ZipFile::open(const ZipEntry& entry) const {
  constexpr std::uint64_t most_packed = 1100;  // deflate packs at most some thousand to one
  const std::string where = name_ + ": " + entry.name;
  if (entry.is_encrypted) throw InvalidInput(where, "is encrypted", "Save the file without a password");
  if (entry.method != 0 && entry.method != 8) {
    throw InvalidInput(where, fmt::format("is packed by method {} of ZIP, and 0 and 8 are read", entry.method),
                       "Save it by numpy.savez or numpy.savez_compressed");
  }
  if (entry.header_at > size_ || size_ - entry.header_at < own_header_bytes) throw InvalidInput(name_, damaged_zip);
  const std::string header = bytes(entry.header_at, own_header_bytes);
  const std::uint64_t begin = entry.header_at + own_header_bytes + little(header, 26, 2) + little(header, 28, 2);
  const bool is_inside = begin <= size_ && entry.packed_bytes <= size_ - begin;
  const bool fits =
      entry.method == 0 ? entry.bytes == entry.packed_bytes : entry.bytes / most_packed <= entry.packed_bytes;
  if (little(header, 0, 4) != header_mark || !is_inside || !fits) throw InvalidInput(where, damaged_zip);
  return std::make_unique<ZipBytes>(std::make_unique<FileBytes>(file_.get(), begin, entry.packed_bytes, name_), entry,
                                    where);
}

}  // namespace robomill::io
