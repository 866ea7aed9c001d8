#include "robomill/io/records/tree/packed_tree.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/system/child.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace packed_tree_test {

/// Words that the reader of records looks for, among others.
constexpr const char* keys[] = {"time", "t_ms", "fs",          "dt",    "unit", "force_unit", "force",  "values",
                                "x",    "rate", "sensitivity", "names", "",     "label",      "signals"};
constexpr const char* words[] = {"N", "ms", "s", "", "Force", "a,b", "1000", "a; b; c", "\xff\xfe", "kHz"};

/// A tree as a file may have it: structs within structs, cells, matrices, texts, and what is no signal.
FileTree random_tree(Random& random, FileTree::Naming naming) {
  FileTree out(naming);
  for (std::uint64_t i = 1 + random.index(12); i > 0; --i) {
    FileNode node{.parent = random.index(out.nodes.size()), .kind = static_cast<FileNode::Kind>(random.index(3))};
    node.key = keys[random.index(std::size(keys))];
    node.name = out.nodes[node.parent].name.empty() ? node.key : out.nodes[node.parent].name + "." + node.key;
    if (node.kind == FileNode::Kind::texts) {
      for (std::uint64_t k = random.index(4); k > 0; --k)
        node.texts.emplace_back(words[random.index(std::size(words))]);
    } else if (node.kind == FileNode::Kind::numbers && random.index(5) == 0) {
      node.fault = "complex numbers";
    } else if (node.kind == FileNode::Kind::numbers) {
      node.by_rows = random.index(2) == 0;
      const auto samples = static_cast<Eigen::Index>(1 + random.index(6));
      for (std::uint64_t k = 1 + random.index(3); k > 0; --k) {
        const Eigen::VectorXd& column = node.columns.emplace_back(Eigen::VectorXd::LinSpaced(samples, 0.0, 1.0));
        if (random.index(8) == 0) node.columns.back()(column.size() / 2) = std::numeric_limits<double>::quiet_NaN();
      }
    }
    out.add(std::move(node));
  }
  return out;
}

/// Bytes of all numbers and texts of a tree.
std::size_t held_bytes(const FileTree& tree) {
  std::size_t out = 0;
  for (const FileNode& node : tree.nodes) {
    out += node.name.size() + node.key.size() + node.fault.size();
    for (const std::string& text : node.texts) out += 8 + text.size();
    for (const Eigen::VectorXd& column : node.columns) out += 8 * static_cast<std::size_t>(column.size());
  }
  return out;
}

/// A number of eight bytes that means trouble: near what is held, huge, or so that a product of it wraps round.
std::uint64_t trouble(Random& random, std::size_t bytes) {
  constexpr std::uint64_t huge[] = {1ULL << 61U, 1ULL << 60U, 1ULL << 63U, ~0ULL, (1ULL << 61U) + 1, 1ULL << 32U};
  return random.index(2) == 0 ? huge[random.index(std::size(huge))] : random.index(2 * bytes);
}

std::string mutated(std::string bytes, Random& random) {
  for (std::uint64_t i = random.index(4); i > 0; --i) {
    bytes[random.index(bytes.size())] = static_cast<char>(random.index(3) == 0 ? 255 : random.index(256));
  }
  // Sizes stand at any byte, since texts do.
  for (std::uint64_t i = random.index(3); i > 0 && bytes.size() > 8; --i) {
    const std::uint64_t number = trouble(random, bytes.size());
    std::memcpy(bytes.data() + random.index(bytes.size() - 8), &number, sizeof(number));
  }
  if (random.index(3) == 0) bytes.resize(random.index(bytes.size()) + 1);
  if (random.index(6) == 0) bytes += bytes.substr(random.index(bytes.size()));
  return bytes;
}

/// What is wrong with how a mutated tree is taken; empty: nothing.
std::string fault_of(const std::string& bytes, FileTree::Naming naming) {
  std::optional<FileTree> tree;
  try {
    tree = unpack_tree(bytes, naming);
  } catch (const std::length_error&) {
    return {};
  }
  if (held_bytes(*tree) > bytes.size()) return "more than its bytes";
  for (std::size_t i = 1; i < tree->nodes.size(); ++i) {
    if (tree->nodes[i].parent >= i) return "a node before what it is within";
  }
  try {
    const Record record = record_of_tree(*std::move(tree), "a.mat", "");
    if (record.columns.size() != record.names.size()) return "columns without names";
    for (const Eigen::VectorXd& column : record.columns) {
      if (!column.allFinite()) return "a value is no finite number";
    }
    if (!std::isfinite(record.sample_rate_hz) || record.sample_rate_hz < 0.0) return "no rate";
  } catch (const InvalidInput&) {
  }
  return {};
}

constexpr FileTree::Naming namings[] = {FileTree::Naming::matlab, FileTree::Naming::python};

TEST(PackedTree, ComesBackAsItWas) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const FileTree tree = random_tree(random, namings[random.index(2)]);
    const FileTree back = unpack_tree(pack_tree(tree), tree.naming);
    EXPECT_EQ(back.naming, tree.naming);
    ASSERT_EQ(back.nodes.size(), tree.nodes.size());
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
      const FileNode &one = tree.nodes[i], &other = back.nodes[i];
      EXPECT_EQ(one.parent, other.parent);
      EXPECT_EQ(one.kind, other.kind);
      EXPECT_EQ(one.name, other.name);
      EXPECT_EQ(one.key, other.key);
      EXPECT_EQ(one.by_rows, other.by_rows);
      EXPECT_EQ(one.texts, other.texts);
      EXPECT_EQ(one.fault, other.fault);
      ASSERT_EQ(one.columns.size(), other.columns.size());
      for (std::size_t k = 0; k < one.columns.size(); ++k) {
        ASSERT_EQ(one.columns[k].size(), other.columns[k].size());
        const auto bytes = static_cast<std::size_t>(one.columns[k].size()) * sizeof(double);
        EXPECT_EQ(std::memcmp(one.columns[k].data(), other.columns[k].data(), bytes), 0);
      }
    }
  }
  EXPECT_EQ(unpack_tree({}, FileTree::Naming::matlab).nodes.size(), 1U);
}

/// Of one seed: a tree, and copies of its bytes that are damaged.
std::string fault_of_seed(int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  const FileTree::Naming naming = namings[random.index(2)];
  const std::string packed = pack_tree(random_tree(random, naming));
  for (int copy = 0; copy < 20; ++copy) {
    if (std::string fault = fault_of(mutated(packed, random), naming); !fault.empty()) {
      return fmt::format("seed {}, copy {}: {}", seed, copy, fault);
    }
  }
  return {};
}

// A damaged file may make the child that reads it say anything. In a child again, which may neither take much memory
// nor go on for ever, nor die.
TEST(PackedTree, SurvivesMutations) {
  constexpr int at_a_time = 500;
  const int all = test::seeds(20000);
  for (int first = 0; first < all; first += at_a_time) {
    const auto said = run_in_child({.more_memory_bytes = std::size_t{32} << 20}, [&]() -> std::string {
      for (int seed = first; seed < first + at_a_time; ++seed) {
        if (std::string fault = fault_of_seed(seed); !fault.empty()) return fault;
      }
      return "well";
    });
    ASSERT_EQ(said.value_or("died, hung or took too much"), "well") << "seeds from " << first;
  }
}

// Every number of its sizes, with what would wrap round or ask for all memory.
TEST(PackedTree, BelievesNoSize) {
  FileTree tree(FileTree::Naming::matlab);
  tree.add({.kind = FileNode::Kind::texts, .name = "units", .key = "units", .texts = {"N", "g"}});
  tree.add({.kind = FileNode::Kind::numbers,
            .name = "x",
            .key = "x",
            .columns = {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)}});
  const std::string packed = pack_tree(tree);
  for (const std::uint64_t number : {std::uint64_t{1} << 61U, (std::uint64_t{1} << 61U) + 3, std::uint64_t{1} << 60U,
                                     ~std::uint64_t{0}, std::uint64_t{1} << 32U, std::uint64_t{packed.size()}}) {
    for (std::size_t at = 0; at + sizeof(number) <= packed.size(); ++at) {
      std::string bytes = packed;
      std::memcpy(bytes.data() + at, &number, sizeof(number));
      EXPECT_EQ(fault_of(bytes, tree.naming), "") << number << " at " << at;
    }
  }
  for (std::size_t size = 1; size < packed.size(); ++size) {
    EXPECT_EQ(fault_of(packed.substr(0, size), tree.naming), "") << size;
  }
}

}  // namespace packed_tree_test
}  // namespace robomill::io
