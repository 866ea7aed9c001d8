#include "robomill/path/files/sample_spool.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::path {
namespace {

constexpr std::size_t chunk_rows = 4096;

}  // namespace

SampleSpool::SampleSpool(const std::filesystem::path& beside) : beside_(beside) {
  const std::filesystem::path folder = beside.has_parent_path() ? beside.parent_path() : ".";
  std::string name = (folder / (".robomill-samples-" + std::string(6, 'X'))).string();
  const int descriptor = ::mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) fail("cannot be written");
  ::unlink(name.c_str());
  file_.reset(::fdopen(descriptor, "w+b"));
  if (file_ == nullptr) {
    ::close(descriptor);
    fail("cannot be written");
  }
}

void SampleSpool::fail(const char* what) const {
  throw InvalidInput(beside_.string(), what, std::strerror(errno));
}

void SampleSpool::clear() {
  size_ = 0;
  writing_ = true;
  for (Chunk& chunk : chunks_) chunk.number = SIZE_MAX;
  std::rewind(file_.get());
}

void SampleSpool::add(const Sample& sample) {
  Row row;
  Eigen::Map<robot::Position6>(row.joints.data()) = sample.joints;
  row.block = sample.block;
  if (std::fwrite(&row, sizeof row, 1, file_.get()) != 1) fail("cannot be written");
  ++size_;
}

SampleSpool::Row SampleSpool::row(std::size_t index) {
  if (writing_ && std::fflush(file_.get()) != 0) fail("cannot be written");
  writing_ = false;
  const std::size_t number = index / chunk_rows;
  Chunk& chunk = chunks_.at(number % chunks_.size());
  if (chunk.number != number) {
    const std::size_t first = number * chunk_rows;
    chunk.rows.resize(std::min(chunk_rows, size_ - first));
    chunk.number = SIZE_MAX;
    if (::fseeko(file_.get(), static_cast<off_t>(first * sizeof(Row)), SEEK_SET) != 0 ||
        std::fread(chunk.rows.data(), sizeof(Row), chunk.rows.size(), file_.get()) != chunk.rows.size()) {
      fail("cannot be read back");
    }
    chunk.number = number;
  }
  return chunk.rows[index % chunk_rows];
}

}  // namespace robomill::path
