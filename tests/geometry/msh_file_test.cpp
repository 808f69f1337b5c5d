#include "softfinger/geometry/msh_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "softfinger/base/error.hpp"

namespace softfinger {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

/// Text of an MSH 2.2 file from its parts.
struct Msh {
  std::string format = "2.2 0 8";
  std::string names = "3\n2 1 \"skin\"\n2 2 \"bone\"\n3 1 \"tissue\"\n";
  std::vector<std::string> nodes{"1 0 0 0", "2 1 0 0", "3 0 1 0", "4 0 0 1"};
  std::vector<std::string> elements{"1 2 2 1 1 1 2 3", "2 2 2 2 1 1 2 4", "3 4 2 1 1 1 2 3 4"};

  [[nodiscard]] std::string text() const {
    const auto section = [](const std::string& name, const std::vector<std::string>& lines) {
      std::string result = "$" + name + "\n" + std::to_string(lines.size()) + "\n";
      for (const std::string& line : lines) result += line + "\n";
      return result + "$End" + name + "\n";
    };
    return "$MeshFormat\n" + format + "\n$EndMeshFormat\n$PhysicalNames\n" + names +
           "$EndPhysicalNames\n" + section("Nodes", nodes) + section("Elements", elements);
  }
};

class MshFileTest : public ::testing::Test {
 protected:
  TetrahedralMesh read(const std::string& text, double scale = 1e-3) {
    std::ofstream(file_, std::ios::binary) << text;
    return read_msh(file_, scale);
  }
  std::string error(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& thrown) {
      const std::string message = thrown.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_EQ(message.rfind(file_.string(), 0), 0u) << message;
      return message.substr(file_.string().size());
    }
    ADD_FAILURE() << "nothing thrown for:\n" << text;
    return {};
  }
  std::string error(const Msh& msh) { return error(msh.text()); }
  void TearDown() override { std::filesystem::remove(file_); }

  std::filesystem::path file_ =
      std::filesystem::path(::testing::TempDir()) /
      (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".msh");
};

TEST_F(MshFileTest, ReadsGroupsAndScales) {
  const TetrahedralMesh mesh = read(Msh().text());
  ASSERT_EQ(mesh.nodes.size(), 4u);
  EXPECT_EQ(mesh.nodes[3], Vector3(0.0, 0.0, 1e-3));
  EXPECT_THAT(mesh.tetrahedra, ElementsAre(std::array{0, 1, 2, 3}));
  EXPECT_THAT(mesh.volume_names, ElementsAre("tissue"));
  EXPECT_THAT(mesh.surface_names, ElementsAre("skin", "bone"));
  EXPECT_THAT(mesh.triangle_surface, ElementsAre(0, 1));
}

TEST_F(MshFileTest, TrianglesPointOutward) {
  for (const std::string nodes : {"1 2 3", "1 3 2", "3 2 1"}) {
    Msh msh;
    msh.elements[0] = "1 2 2 1 1 " + nodes;
    const TetrahedralMesh mesh = read(msh.text());
    const auto corner = [&](int k) {
      return mesh.nodes[static_cast<std::size_t>(mesh.triangles[0][static_cast<std::size_t>(k)])];
    };
    EXPECT_LT((corner(1) - corner(0)).cross(corner(2) - corner(0)).z(), 0.0);
  }
}

TEST_F(MshFileTest, ReadsWhatOthersWrite) {
  Msh msh;  // sparse ids, an unused node, points, lines, sections of no interest, DOS line ends
  msh.nodes = {"90 5 5 5", "10 0 0 0", "20 1e0 0 0", "30 0 1.0 0", "40 0 0 1E+0"};
  msh.elements = {"7 15 2 0 1 10", "8 1 2 0 1 10 20", "9 2 2 0 1 10 20 30",
                  "11 4 2 1 1 10 20 30 40", "12 2 3 1 1 5 10 20 30"};
  std::string text =
      "$Comments\nanything\n$EndComments\n" + msh.text() + "$NodeData\n1\n\"x\"\n$EndNodeData\n";
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.insert(at, "\r");
  }
  const TetrahedralMesh mesh = read(text, 1.0);
  EXPECT_EQ(mesh.nodes.size(), 4u);
  EXPECT_EQ(mesh.nodes[1], Vector3(1.0, 0.0, 0.0));
  EXPECT_EQ(mesh.triangles.size(), 1u);  // the one of no group is left out
}

TEST_F(MshFileTest, GroupsWithoutNameGoByNumber) {
  Msh msh;
  msh.names = "1\n2 1 \"skin\"\n";
  const TetrahedralMesh mesh = read(msh.text());
  EXPECT_THAT(mesh.surface_names, ElementsAre("skin", "2"));
  EXPECT_THAT(mesh.volume_names, ElementsAre("1"));
}

TEST_F(MshFileTest, RefusesOtherFormats) {
  Msh msh;
  msh.format = "4.1 0 8";
  EXPECT_EQ(error(msh), ":2: is MSH version 4.1, expected 2.2; convert it with: gmsh " +
                            file_.string() + " -save -format msh22 -o converted.msh");
  msh.format = "2.2 1 8";
  EXPECT_THAT(error(msh), HasSubstr(":2: is a binary MSH file, expected ASCII; convert it with"));
  EXPECT_THAT(error("solid cube\n"), EndsWith("is not a Gmsh MSH file: expected $MeshFormat"));
  EXPECT_THAT(error(""), EndsWith("it is empty"));
  EXPECT_THAT(error("$NOD\n1\n"), HasSubstr("expected $MeshFormat"));
}

TEST_F(MshFileTest, RefusesSurfaceMesh) {
  Msh msh;
  msh.elements.pop_back();
  EXPECT_THAT(error(msh), HasSubstr("has no tetrahedra: it is a surface mesh"));
}

TEST_F(MshFileTest, RefusesInvertedAndDegenerateElements) {
  Msh msh;
  msh.elements[2] = "3 4 2 1 1 2 1 3 4";
  EXPECT_EQ(error(msh), ":21: tetrahedron 3 is inverted: its nodes are in left-handed order");
  msh.elements[2] = "3 4 2 1 1 1 2 3 3";
  EXPECT_THAT(error(msh), HasSubstr("tetrahedron 3 is degenerate"));
  msh = Msh();
  msh.nodes[3] = "4 0.3 0.3 0";
  EXPECT_THAT(error(msh), HasSubstr("tetrahedron 3 is degenerate"));
  msh.nodes[3] = "4 0.3 0.3 1e-7";
  EXPECT_THAT(error(msh), HasSubstr("tetrahedron 3 is degenerate"));
  msh.nodes = {"1 0 0 0", "2 0 0 0", "3 0 0 0", "4 0 0 0"};
  EXPECT_THAT(error(msh), HasSubstr("tetrahedron 3 is degenerate"));
}

TEST_F(MshFileTest, RefusesTriangleThatIsNoFace) {
  Msh msh;
  msh.nodes.push_back("5 9 9 9");
  msh.elements[0] = "1 2 2 1 1 1 2 5";
  EXPECT_EQ(error(msh), ":20: triangle 1 is no face of a tetrahedron");
  msh.elements[0] = "1 2 2 1 1 1 2 2";
  EXPECT_THAT(error(msh), EndsWith("triangle 1 is no face of a tetrahedron"));
}

TEST_F(MshFileTest, RefusesBoundaryThatIsNoManifold) {
  Msh edge;  // two tetrahedra that share only an edge
  edge.nodes.insert(edge.nodes.end(), {"5 0 -1 0", "6 0 0 -1"});
  edge.elements.push_back("4 4 2 1 1 1 2 5 6");
  EXPECT_THAT(error(edge),
              HasSubstr("more than two of its triangles meet at an edge (nodes 1, 2)"));
  Msh node;  // ... only a node
  node.nodes.insert(node.nodes.end(), {"5 -1 0 0", "6 0 -1 0", "7 0 0 -1"});
  node.elements.push_back("4 4 2 1 1 1 5 7 6");
  EXPECT_THAT(error(node), HasSubstr("two of its sheets touch at one node (node 1)"));
  Msh twice;
  twice.elements.push_back("4 4 2 1 1 1 2 3 4");
  EXPECT_THAT(error(twice), HasSubstr(":22: tetrahedron 4: two tetrahedra overlap"));
  twice.elements.push_back("5 4 2 1 1 1 2 3 4");
  EXPECT_THAT(error(twice), HasSubstr("more than two tetrahedra"));
}

TEST_F(MshFileTest, RefusesDamage) {
  const std::string good = Msh().text();
  // Cut anywhere, the file is refused or misses nothing but white space or the last end mark.
  for (std::size_t size = 0; size + 2 < good.size(); ++size) {
    EXPECT_FALSE(error(good.substr(0, size)).empty());
  }
  Msh msh;
  msh.nodes[1] = "2 1 zero 0";
  EXPECT_EQ(error(msh), ":13: expected number, x, y and z of node 2 of 4");
  msh.nodes[1] = "2 1 0,5 0";
  EXPECT_THAT(error(msh), HasSubstr(":13: expected number, x, y and z"));
  msh.nodes[1] = "2 nan 0 0";
  EXPECT_THAT(error(msh), HasSubstr("node 2 has a coordinate not finite"));
  msh.nodes[1] = "1 1 0 0";
  EXPECT_THAT(error(msh), HasSubstr("node 1 is given twice"));
  msh = Msh();
  msh.elements[2] = "3 4 2 1 1 1 2 3 44";
  EXPECT_THAT(error(msh), HasSubstr("element 3 names node 44, which is not in $Nodes"));
  msh.elements[2] = "3 11 2 1 1 1 2 3 4 1 1 1 1 1 1";
  EXPECT_THAT(error(msh),
              HasSubstr("element 3 has type 11; only triangles (2) and tetrahedra (4)"));
  msh.elements[2] = "3 4 -2 1 1 1 2 3 4";
  EXPECT_THAT(error(msh), HasSubstr("expected number, type and tags"));
}

TEST_F(MshFileTest, DoesNotTrustCounts) {
  std::string text = Msh().text();
  const auto replace = [&](const std::string& from, const std::string& to) {
    std::string copy = text;
    return copy.replace(copy.find(from), from.size(), to);
  };
  EXPECT_THAT(error(replace("$Nodes\n4", "$Nodes\n1999999")), HasSubstr("of node 5 of 1999999"));
  EXPECT_THAT(error(replace("$Nodes\n4", "$Nodes\n99999999999")), HasSubstr("at most 2000000"));
  EXPECT_THAT(error(replace("$Nodes\n4", "$Nodes\n-4")), HasSubstr("expected the count of $Nodes"));
  EXPECT_THAT(error(replace("$Nodes\n4", "$Nodes\n3")), HasSubstr("expected $EndNodes"));
}

TEST(MshFile, RefusesFileThatIsNotThere) {
  EXPECT_THROW((void)read_msh("absent.msh", 1.0), InputError);
  EXPECT_THROW((void)read_msh(::testing::TempDir(), 1.0), InputError);
}

}  // namespace
}  // namespace softfinger
