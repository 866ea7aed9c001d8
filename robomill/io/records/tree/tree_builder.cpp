#include "robomill/io/records/tree/tree_builder.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robomill/base/error.hpp"
#include "robomill/io/records/channels.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t most_nodes = 100000;

}  // namespace

std::uint64_t most_values_of(std::uint64_t file_bytes) {
  return std::min(most_record_values, (std::uint64_t{8} << 20) + 8 * file_bytes);
}

std::size_t TreeBuilder::add(FileNode node) {
  if (tree_.nodes.size() >= most_nodes) {
    throw InvalidInput(file_, fmt::format("holds more than {} values, groups and attributes", most_nodes),
                       "Save the channels alone");
  }
  return tree_.add(std::move(node));
}

std::size_t TreeBuilder::add_group(std::size_t parent, std::string name, std::string key) {
  return add({.parent = parent, .kind = FileNode::Kind::group, .name = std::move(name), .key = std::move(key)});
}

void TreeBuilder::add_texts(std::size_t parent, std::string name, std::string key, std::vector<std::string> texts) {
  FileNode node{.parent = parent, .kind = FileNode::Kind::texts, .name = std::move(name), .key = std::move(key)};
  node.texts = std::move(texts);
  add(std::move(node));
}

void TreeBuilder::add_fault(std::size_t parent, std::string name, std::string key, std::string fault) {
  FileNode node{.parent = parent, .kind = FileNode::Kind::numbers, .name = std::move(name), .key = std::move(key)};
  node.fault = std::move(fault);
  add(std::move(node));
}

void TreeBuilder::require_room(const std::string& name, std::uint64_t rows, std::uint64_t columns) {
  if (columns == 0 || rows <= left_ / columns) {
    left_ -= rows * columns;
    return;
  }
  throw InvalidInput(
      file_,
      fmt::format("{} says that it holds {} x {} values, more than a file of its size is given", name, rows, columns),
      "Is it damaged? Else save it uncompressed, or cut the recording into shorter ones");
}

std::string TreeBuilder::lie_fault(std::uint64_t rows, std::uint64_t columns) {
  const std::uint64_t across = std::min(rows, columns);
  if (across <= most_channels) return {};
  return fmt::format("{} x {}: at most {} channels are read", rows, columns, most_channels);
}

bool squeezed(const std::vector<std::uint64_t>& sides, std::uint64_t& rows, std::uint64_t& columns) {
  const auto others = std::ranges::count_if(sides, [](std::uint64_t side) { return side != 1; });
  if (others > 2) return false;
  rows = columns = 1;
  if (sides.size() == 2) {
    rows = sides[0];
    columns = sides[1];
    return true;
  }
  bool first = true;
  for (const std::uint64_t side : sides) {
    if (side == 1) continue;
    (first ? rows : columns) = side;
    first = false;
  }
  return true;
}

std::string utf8_of(const std::uint16_t* letters, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned code = letters[i];
    if (code < 0x80) {
      out += static_cast<char>(code);
    } else if (code < 0x800) {
      out += static_cast<char>(0xC0U | code >> 6U);
      out += static_cast<char>(0x80U | (code & 0x3FU));
    } else {
      out += static_cast<char>(0xE0U | code >> 12U);
      out += static_cast<char>(0x80U | (code >> 6U & 0x3FU));
      out += static_cast<char>(0x80U | (code & 0x3FU));
    }
  }
  return out;
}

}  // namespace robomill::io
