#include "robomill/io/records/numpy/npy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/byte_order.hpp"
#include "robomill/io/records/channels.hpp"
#include "robomill/io/records/numpy/npy_format.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 16;
constexpr std::uint64_t most_texts = 4096, most_text_bytes = std::uint64_t{1} << 20;

/// Where the values of a field go.
class NpyTarget {
 public:
  /// @param shape  of the array, without sides of one element: none to two
  NpyTarget(const NpyField& field, const std::vector<std::uint64_t>& shape, bool fortran_order)
      : field_(field), decode_(field.type.tick_s > 0.0 ? nullptr : field.type.decoder()) {
    const std::uint64_t rows = shape.empty() ? 1 : shape[0];
    const std::uint64_t across = shape.size() < 2 ? 1 : shape[1];
    lie_ = matrix_lie(rows, across);
    const std::uint64_t columns = field.count > 1 ? field.count : lie_.columns;
    columns_.assign(static_cast<std::size_t>(columns), Eigen::VectorXd(static_cast<Eigen::Index>(lie_.samples)));
    // Either the samples of a column follow each other, or a sample of each column does.
    samples_together_ = shape.size() < 2 || fortran_order != lie_.by_rows;
  }

  void take(const char* item) {
    if (field_.count > 1) {
      for (std::size_t i = 0; i < field_.count; ++i) put(i, sample_, item + i * field_.type.size);
      ++sample_;
      return;
    }
    put(column_, sample_, item);
    if (samples_together_) {
      if (static_cast<std::uint64_t>(++sample_) == lie_.samples) {
        sample_ = 0;
        ++column_;
      }
    } else if (++column_ == columns_.size()) {
      column_ = 0;
      ++sample_;
    }
  }

  [[nodiscard]] std::vector<Eigen::VectorXd>& columns() { return columns_; }
  [[nodiscard]] bool by_rows() const { return lie_.by_rows; }
  [[nodiscard]] std::size_t offset() const { return field_.offset; }

 private:
  void put(std::size_t column, Eigen::Index sample, const char* at) {
    columns_[column](sample) = decode_ != nullptr ? decode_(at) : time_s(at);
  }

  /// A date from the begin of its first day on: as a number of ticks it has more digits than a double.
  double time_s(const char* at) {
    constexpr auto no_time = std::numeric_limits<std::int64_t>::min();
    const auto ticks = std::bit_cast<std::int64_t>(number_at(std::string_view(at, 8), 0, 8, field_.type.big_endian));
    if (ticks == no_time) return std::numeric_limits<double>::quiet_NaN();
    if (!began_ && field_.type.kind == 'M') {
      const auto day = std::max<std::int64_t>(1, std::llround(86400.0 / field_.type.tick_s));
      zero_ = static_cast<std::uint64_t>(ticks) - static_cast<std::uint64_t>((ticks % day + day) % day);
    }
    began_ = true;
    const auto since = std::bit_cast<std::int64_t>(static_cast<std::uint64_t>(ticks) - zero_);
    return field_.type.tick_s * static_cast<double>(since);
  }

  NpyField field_;
  double (*decode_)(const char*);
  MatrixLie lie_ = {};
  bool samples_together_ = true, began_ = false;
  std::uint64_t zero_ = 0;  ///< the tick that times count from
  std::size_t column_ = 0;
  Eigen::Index sample_ = 0;
  std::vector<Eigen::VectorXd> columns_;
};

/// A text of NumPy: bytes, or four of them a letter, filled up with zeros.
std::string npy_text(std::string_view bytes, const NpyType& type) {
  std::string out;
  const std::size_t wide = type.kind == 'U' ? 4 : 1;
  for (std::size_t at = 0; at + wide <= bytes.size(); at += wide) {
    const auto code = static_cast<std::uint32_t>(number_at(bytes, at, wide, type.big_endian));
    if (code == 0) break;
    if (wide == 1 || code < 0x80) {
      out += static_cast<char>(code);
    } else if (code < 0x800) {
      out += static_cast<char>(0xC0 | code >> 6);
      out += static_cast<char>(0x80 | (code & 0x3F));
    } else {
      out += '?';
    }
  }
  return out;
}

class NpyReader {
 public:
  NpyReader(ByteSource& bytes, const std::string& where, const std::string& name, FileTree& tree, std::uint64_t& values)
      : bytes_(bytes), where_(where), name_(name), tree_(tree), left_(values), header_(read_npy_header(bytes, where)) {
    for (const std::uint64_t side : header_.shape) {
      if (side != 1) shape_.push_back(side);
    }
  }

  void read() {
    require_held();
    if (header_.is_structured && !name_.empty()) {
      group_ = tree_.add({.kind = FileNode::Kind::group, .name = name_, .key = name_});
    }
    const NpyType& type = header_.fields.empty() ? NpyType{} : header_.fields.front().type;
    const bool is_list =
        shape_.size() < 2 && header_.items <= most_texts && header_.items * header_.item_bytes <= most_text_bytes;
    if (!header_.is_structured && (type.kind == 'U' || type.kind == 'S' || type.kind == 'a') && is_list) {
      read_texts(type);
      return;
    }
    std::vector<NpyTarget> targets;
    std::vector<const NpyField*> fields;
    for (const NpyField& field : header_.fields) {
      const std::string fault = fault_of(field);
      if (!fault.empty()) {
        tree_.add(node(field, fault));
        continue;
      }
      require_room(field);
      targets.emplace_back(field, shape_, header_.fortran_order);
      fields.push_back(&field);
    }
    if (targets.empty()) return;
    read_values(targets);
    for (std::size_t i = 0; i < targets.size(); ++i) add(*fields[i], targets[i]);
  }

 private:
  void require_held() {
    const std::uint64_t rest = bytes_.size() - header_.begin;
    if (header_.item_bytes > 0 && header_.items > rest / header_.item_bytes) {
      throw InvalidInput(where_,
                         fmt::format("its header states {} values of {} bytes, and {} bytes follow", header_.items,
                                     header_.item_bytes, rest),
                         "Was it cut off?");
    }
    if (const std::uint64_t more = rest - header_.items * header_.item_bytes; more > 0) {
      tree_.notes.push_back(fmt::format("{}{}: {} bytes behind the array are left out: is there a second one?",
                                        warning_label, where_, more));
    }
  }

  void require_room(const NpyField& field) {
    const std::uint64_t count = header_.items * field.count;
    if (header_.items > left_ || count > left_) {
      throw InvalidInput(where_,
                         fmt::format("would take {} MB of memory, more than a file of its size is given",
                                     header_.items * 8 / 1000000 * field.count),
                         "Cut the recording into shorter ones, or save it uncompressed (numpy.savez)");
    }
    left_ -= count;
  }

  [[nodiscard]] std::string fault_of(const NpyField& field) const {
    if (!field.type.fault.empty()) return field.type.fault;
    if (header_.items == 0 || field.count == 0) return "no values";
    const std::size_t dimensions = shape_.size() + (field.count > 1 ? 1 : 0);
    if (dimensions > 2) return fmt::format("of {} dimensions: a record is of one or two", dimensions);
    if (header_.is_structured && shape_.size() > 1) return "fields of a matrix";
    const std::uint64_t columns = shape_.size() < 2 ? field.count : std::min(shape_[0], shape_[1]);
    if (columns > most_channels) return fmt::format("{} columns: at most {} are read", columns, most_channels);
    return {};
  }

  [[nodiscard]] FileNode node(const NpyField& field, std::string fault) const {
    FileNode out{.parent = group_, .kind = FileNode::Kind::numbers, .fault = std::move(fault)};
    out.key = header_.is_structured ? field.name : name_;
    out.name = header_.is_structured && !name_.empty() ? name_ + "." + field.name : out.key;
    return out;
  }

  void read_texts(const NpyType& type) {
    FileNode out{.kind = FileNode::Kind::texts, .name = name_, .key = name_};
    std::string text(header_.item_bytes, '\0');
    for (std::uint64_t i = 0; i < header_.items; ++i) {
      read_whole(text);
      out.texts.push_back(npy_text(text, type));
    }
    tree_.add(std::move(out));
  }

  void read_whole(std::span<char> to) {
    if (bytes_.read(to) < to.size()) throw InvalidInput(where_, "ends within its values", "Was it cut off?");
  }

  void read_values(std::vector<NpyTarget>& targets) {
    const std::size_t a_block = std::max<std::size_t>(1, block_bytes / header_.item_bytes);
    std::string block(a_block * header_.item_bytes, '\0');
    for (std::uint64_t at = 0; at < header_.items; at += a_block) {
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(a_block, header_.items - at));
      read_whole(std::span(block).first(count * header_.item_bytes));
      for (NpyTarget& target : targets) {
        for (std::size_t i = 0; i < count; ++i) target.take(block.data() + i * header_.item_bytes + target.offset());
      }
    }
  }

  void add(const NpyField& field, NpyTarget& target) {
    FileNode out = node(field, {});
    out.columns = std::move(target.columns());
    out.by_rows = target.by_rows();
    const std::size_t place = tree_.add(std::move(out));
    if (field.type.tick_s == 0.0) return;
    tree_.add({.parent = place, .kind = FileNode::Kind::texts, .key = "unit", .texts = {"s"}});
  }

  ByteSource& bytes_;
  const std::string& where_;
  const std::string& name_;
  FileTree& tree_;
  std::uint64_t& left_;
  NpyHeader header_;
  std::vector<std::uint64_t> shape_;  ///< without sides of one element
  std::size_t group_ = 0;
};

}  // namespace

void read_npy(ByteSource& bytes, const std::string& where, const std::string& name, FileTree& tree,
              std::uint64_t& values) {
  NpyReader(bytes, where, name, tree, values).read();
}

}  // namespace robomill::io
