#include "robomill/io/records/tree/packed_tree.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "robomill/io/packed.hpp"

namespace robomill::io {
namespace {

/// Of a node: parent, kind, by_rows, number of columns, values of each, number of texts.
using PackedSizes = std::array<std::uint64_t, 6>;

Eigen::VectorXd unpack_values(Unpacker& from, std::uint64_t count) {
  from.require(count, sizeof(double));
  Eigen::VectorXd out(static_cast<Eigen::Index>(count));
  from.values({out.data(), static_cast<std::size_t>(count)});
  return out;
}

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
      pack_number(out, number);
    }
    for (const std::string* text : {&node.name, &node.key, &node.fault}) pack_text(out, *text);
    for (const std::string& text : node.texts) pack_text(out, text);
    for (Eigen::VectorXd& column : node.columns) {
      pack_values(out, {column.data(), static_cast<std::size_t>(samples)});
      column = {};
    }
  }
  return out;
}

FileTree unpack_tree(std::string_view bytes, FileTree::Naming naming) {
  FileTree out(naming);
  Unpacker from(bytes);
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
    for (std::uint64_t i = 0; i < columns; ++i) node.columns.push_back(unpack_values(from, samples));
    out.add(std::move(node));
  }
  return out;
}

}  // namespace robomill::io
