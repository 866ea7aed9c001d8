#include "robomill/io/stl.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "robomill/base/random.hpp"
#include "testing/robot/solids.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace stl_test {

using robomill::test::Folder;
using robomill::test::rejection;
using robomill::test::seeds;
namespace solids = robot::testing;

TriangleMesh read(const std::string& content, double unit_m = 1e-3) {
  const Folder folder;
  return read_stl(folder.file("part.stl", content), unit_m);
}

std::string said(const std::string& content) {
  return rejection([&] { static_cast<void>(read(content)); });
}

std::string ascii_stl(const TriangleMesh& mesh, double unit_m) {
  std::string out = "solid a part of one box\n";
  for (const auto& triangle : mesh.triangles) {
    out += "  facet normal 0 0 nan\n    outer loop\n";
    for (const std::uint32_t vertex : triangle) {
      const Eigen::Vector3d at = mesh.vertices_m[vertex] / unit_m;
      out += fmt::format("      vertex {} {} {:e}\n", at.x(), at.y(), at.z());
    }
    out += "    endloop\n  endfacet\n";
  }
  return out + "endsolid\n";
}

/// The volume that a closed mesh encloses, by the divergence theorem.
double volume_m3(const TriangleMesh& mesh) {
  double out = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    out += mesh.vertices_m[a].dot(mesh.vertices_m[b].cross(mesh.vertices_m[c])) / 6.0;
  }
  return out;
}

const TriangleMesh block = solids::box({-0.01, 0.0, 0.002}, {0.03, 0.05, 0.012});

TEST(Stl, ReadsBinaryAndTextAlike) {
  for (const double unit_m : {1e-3, 1.0, 25.4e-3}) {
    for (const std::string& content : {solids::binary_stl(block, unit_m), ascii_stl(block, unit_m)}) {
      const TriangleMesh mesh = read(content, unit_m);
      EXPECT_EQ(mesh.vertices_m.size(), 8U);  // 36 corners brought together
      EXPECT_EQ(mesh.triangles.size(), 12U);
      EXPECT_NEAR(volume_m3(mesh), 0.04 * 0.05 * 0.01, 1e-11);
    }
  }
}

TEST(Stl, TakesABinaryFileThatBeginsWithSolid) {
  const TriangleMesh mesh = read(solids::binary_stl(block, 1e-3, "solid part facet"));
  EXPECT_EQ(mesh.triangles.size(), 12U);
}

TEST(Stl, TakesCapitalsSeveralSolidsAndLineEndsOfAnyKind) {
  std::string text = ascii_stl(block, 1e-3);
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string with_returns;
  for (const char c : text + ascii_stl(solids::moved(block, Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0))), 1e-3)) {
    if (c == '\n') with_returns += '\r';
    with_returns += c;
  }
  const TriangleMesh mesh = read(with_returns);
  EXPECT_EQ(mesh.triangles.size(), 24U);
  EXPECT_NEAR(volume_m3(mesh), 2 * 0.04 * 0.05 * 0.01, 1e-11);
}

TEST(Stl, LeavesOutTrianglesThatCoverNothing) {
  TriangleMesh mesh = block;
  mesh.triangles.push_back({3, 3, 5});
  mesh.triangles.push_back({2, 5, 2});
  EXPECT_EQ(read(solids::binary_stl(mesh)).triangles.size(), 12U);
  EXPECT_NE(said(solids::binary_stl({.vertices_m = {{0, 0, 0}, {0, 0, 1}}, .triangles = {{0, 1, 1}}}))
                .find("holds no triangle"),
            std::string::npos);
}

TEST(Stl, RejectsWhatIsNotWhole) {
  const std::string binary = solids::binary_stl(block);
  EXPECT_NE(said(binary.substr(0, binary.size() - 1)).find("states 12 triangles and holds 11"), std::string::npos);
  EXPECT_NE(said(binary.substr(0, 84)).find("states 12 triangles and holds 0"), std::string::npos);
  EXPECT_NE(said(binary.substr(0, 83)).find("is no STL"), std::string::npos);
  std::string huge = binary;
  for (int i = 80; i < 84; ++i) huge[static_cast<std::size_t>(i)] = '\xff';  // 4,294,967,295 triangles: 200 GB
  EXPECT_NE(said(huge).find("states 4294967295 triangles and holds 12"), std::string::npos);
  EXPECT_NE(said(solids::binary_stl({})).find("holds no triangle"), std::string::npos);
  EXPECT_NE(said("hello").find("is no STL"), std::string::npos);
}

TEST(Stl, RejectsCoordinatesThatAreNone) {
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 2e3}) {
    TriangleMesh mesh = block;
    mesh.vertices_m[7].y() = value;
    for (const std::string& content : {solids::binary_stl(mesh), ascii_stl(mesh, 1e-3)}) {
      EXPECT_NE(said(content).find("triangle 3 = ("), std::string::npos) << said(content);
    }
  }
}

TEST(Stl, NamesTheLineOfATextThatIsNone) {
  const std::string text = ascii_stl(block, 1e-3);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string out = text;
    return out.replace(out.find(from), from.size(), to);
  };
  EXPECT_NE(said(with("vertex", "vortex")).find("part.stl:4: \"vortex\" is no word"), std::string::npos);
  EXPECT_NE(said(with("vertex -10", "vertex x")).find("part.stl:4: must have three numbers"), std::string::npos);
  EXPECT_NE(said(with("      vertex", "  endloop endfacet\n vertex")).find("three corners"), std::string::npos);
  EXPECT_NE(said(with("endloop", "vertex 1 2 3 endloop")).find("three corners"), std::string::npos);
  EXPECT_NE(said(text.substr(0, text.rfind("vertex"))).find("within a facet"), std::string::npos);
  EXPECT_NE(said("solid\nendsolid\n").find("holds no triangle"), std::string::npos);
}

TEST(Stl, RejectsAUnitThatIsNone) {
  const Folder folder;
  const auto path = folder.file("part.stl", solids::binary_stl(block));
  EXPECT_NE(rejection([&] { static_cast<void>(read_stl(path, 0.0)); }).find("unit_m"), std::string::npos);
  EXPECT_NE(rejection([&] { static_cast<void>(read_stl(folder.at("none.stl"))); }).find("none.stl"), std::string::npos);
}

// Files with bytes changed, cut and repeated are read, or rejected by an InvalidInput.
TEST(Stl, SurvivesBrokenFiles) {
  Random random(5);
  const std::string files[] = {solids::binary_stl(block), ascii_stl(block, 1e-3)};
  int rejected = 0;
  for (int k = 0; k < seeds(2000); ++k) {
    std::string content = files[random.index(2)];
    for (std::uint64_t n = random.index(4) + 1; n > 0; --n) {
      content[random.index(content.size())] = static_cast<char>(random.index(256));
    }
    if (random.index(3) == 0) content.resize(random.index(content.size()) + 1);
    try {
      for (const Eigen::Vector3d& vertex : read(content).vertices_m) ASSERT_LE(vertex.cwiseAbs().maxCoeff(), 1e3);
    } catch (const InvalidInput&) {
      ++rejected;
    }
  }
  EXPECT_GT(rejected, seeds(2000) / 4);
}

}  // namespace stl_test
}  // namespace robomill::io
