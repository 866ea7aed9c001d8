#include "robomill/io/records/tree/packed_tree.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

namespace robomill::io {
namespace {

/// Of a node: parent, kind, by_rows, number of columns, values of each, number of texts.
using PackedSizes = std::array<std::uint64_t, 6>;

void add_number(std::string& out, std::uint64_t number) {
  out.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

void add_text(std::string& out, std::string_view text) {
  add_number(out, text.size());
  out += text;
}

class TreeUnpacker {
 public:
  explicit TreeUnpacker(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }
  std::uint64_t number() {
    std::uint64_t out = 0;
    std::memcpy(&out, take(sizeof(out)).data(), sizeof(out));
    return out;
  }
  std::string text() { return std::string(take(number())); }
  Eigen::VectorXd values(std::uint64_t count) {
    if (count > rest_.size() / sizeof(double)) throw std::length_error("more than it has");
    const std::string_view bytes = take(count * sizeof(double));
    Eigen::VectorXd out(static_cast<Eigen::Index>(count));
    if (count > 0) std::memcpy(out.data(), bytes.data(), bytes.size());
    return out;
  }

 private:
  std::string_view take(std::uint64_t count) {
    if (count > rest_.size()) throw std::length_error("less than it says");
    const std::string_view out = rest_.substr(0, static_cast<std::size_t>(count));
    rest_.remove_prefix(out.size());
    return out;
  }
  std::string_view rest_;
};

}  // namespace

std::string pack_tree(FileTree tree) {
  std::size_t bytes = 0;
  for (const FileNode& node : tree.nodes) {
    for (const Eigen::VectorXd& column : node.columns)
      bytes += static_cast<std::size_t>(column.size()) * sizeof(double);
  }
  std::string out;
  out.reserve(bytes + 1000 + 200 * tree.nodes.size());
  for (std::size_t i = 1; i < tree.nodes.size(); ++i) {
    FileNode& node = tree.nodes[i];
    const std::uint64_t samples = node.columns.empty() ? 0 : static_cast<std::uint64_t>(node.columns.front().size());
    for (const std::uint64_t number :
         PackedSizes{node.parent, static_cast<std::uint64_t>(node.kind), node.by_rows ? 1U : 0U, node.columns.size(),
                     samples, node.texts.size()}) {
      add_number(out, number);
    }
    for (const std::string* text : {&node.name, &node.key, &node.fault}) add_text(out, *text);
    for (const std::string& text : node.texts) add_text(out, text);
    for (Eigen::VectorXd& column : node.columns) {
      out.append(reinterpret_cast<const char*>(column.data()), static_cast<std::size_t>(samples) * sizeof(double));
      column = {};
    }
  }
  return out;
}

FileTree unpack_tree(std::string_view bytes, FileTree::Naming naming) {
  FileTree out(naming);
  TreeUnpacker from(bytes);
  while (!from.at_end()) {
    PackedSizes sizes = {};
    for (std::uint64_t& size : sizes) size = from.number();
    const auto [parent, kind, by_rows, columns, samples, texts] = sizes;
    if (parent >= out.nodes.size() || kind > 2 || columns > bytes.size() || texts > bytes.size() ||
        (columns > 0 && samples == 0)) {
      throw std::length_error("of no kind");
    }
    FileNode node{.parent = static_cast<std::size_t>(parent), .kind = static_cast<FileNode::Kind>(kind)};
    node.by_rows = by_rows != 0;
    for (std::string* text : {&node.name, &node.key, &node.fault}) *text = from.text();
    for (std::uint64_t i = 0; i < texts; ++i) node.texts.push_back(from.text());
    for (std::uint64_t i = 0; i < columns; ++i) node.columns.push_back(from.values(samples));
    out.add(std::move(node));
  }
  return out;
}

}  // namespace robomill::io
