// Programs of machines and robots that no reader here knows: named, not misread.
#include "robomill/program/files/unread_dialect.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robomill/program/files/program_files.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::program {
namespace unread_dialect_test {

struct Case {
  const char *name, *text, *says, *remedy;
};

const std::string gcode = "Post-process the path as G-code (.nc, .ngc)";
const std::string path = "Give the path that it was made from";

TEST(UnreadDialects, AreNamedWithTheirRemedy) {
  const Case cases[] = {
      {"plate.h", "0 BEGIN PGM PLATE MM\n1 TOOL CALL 3 Z S8000\n2 L X+1 Y+2 R0 FMAX\n", "(Klartext)", "G-code"},
      {"plate.h", "10 L X+1,5 Y-2 R0 FMAX M3\n", "(Klartext)", "G-code"},
      {"plate.nc", "; by hand\nBLK FORM 0.1 Z X+0 Y+0 Z-9\n", "(Klartext)", "G-code"},
      {"vane.mpf", "N1 G71 G90\nN2 G0 X1 Y2 Z3\n", "Sinumerik 840D", "G-code"},
      {"vane.MPF", "G90 G17\nN20 TRAORI\nG0 X1\n", "Sinumerik 840D", "G-code"},
      {"vane.nc", "G90 G710\nCYCLE832(0.01,1,1)\n", "Sinumerik 840D", "G-code"},
      {"vane.txt", "G1 X1 Y2 Z3 A3=0.1 B3=0 C3=0.99 F800\n", "Sinumerik 840D", "G-code"},
      {"sub.spf", "G90\nG1 X5 F100\nM17\n", "Sinumerik 840D", "G-code"},
      {"mill.src", "&ACCESS RVP\nDEF MILL ( )\nPTP {A1 0,A2 -90}\nEND\n", "(KRL)", "path that it was made from"},
      {"mill.src", "DEF MILL ( )\n  LIN XP1 C_DIS\nEND\n", "(KRL)", "path that it was made from"},
      {"job.ls", "/PROG  JOB\n/MN\n 1:L P[1] 30mm/sec FINE ;\n/POS\n/END\n", "(TP listing)", "path that"},
      {"mill.mod", "MODULE mill\nPROC main()\nMoveL p1,v50,z0,t1;\nENDPROC\nENDMODULE\n", "(RAPID)", "path that"},
      {"mill.txt", "%%%\n VERSION:1\n LANGUAGE:ENGLISH\n%%%\nMODULE a\n", "(RAPID)", "path that"},
      {"part.jbi", "/JOB\n//NAME PART\nNOP\nMOVL C00001 V=20.0\nEND\n", "(INFORM job)", "path that"},
      {"part.script", "def part():\n  movel(p[0.1,0,0.2,0,3.1,0], a=1, v=0.05)\nend\n", "(URScript)", "path that"},
      {"part.nc", "PARTNO PLATE\nUNITS/MM\nGOTO/1,2,3\n", "(APT/CL)", ".apt"},
  };
  const test::Folder folder;
  for (const Case& one : cases) {
    const auto file = folder.file(one.name, one.text);
    const std::string said = test::rejection([&] { static_cast<void>(read_program(file)); });
    EXPECT_NE(said.find(one.says), std::string::npos) << one.name << ": " << said;
    EXPECT_NE(said.find(one.remedy), std::string::npos) << one.name << ": " << said;
    EXPECT_NE(said.find(one.name + std::string(":")), std::string::npos) << said;
    EXPECT_EQ(said.find("frame"), std::string::npos) << said;
  }
}

TEST(UnreadDialects, WhatMayBeGcodeIsRead) {
  for (const char* name : {"part.nc", "part.mpf", "part.h", "part.txt", "part"}) {
    EXPECT_FALSE(
        unread_dialect(std::filesystem::path(name).extension().string(),
                       "%\n(module of Klartext, TRAORI off, movel( [BEGIN PGM])\nN10 G21 G90 G17 ; MoveL, T=\"B\"\n"
                       "N20 G0 X1 Y2 Z3.\nG1 Z0 F100\n/G1 X5\n//PLATE 1\nM30\n%\n"))
        << name;
  }
}

TEST(UnreadDialects, AUnitIsNoFrame) {
  const test::Folder folder;
  for (const auto& [code, unit_m] : {std::pair{"G71", 1e-3}, {"G70", 25.4e-3}}) {
    const auto file = folder.file("unit.nc", std::string(code) + " G90\nG0 X1 Y0 Z0\n");
    const Program program = read_program(file);
    EXPECT_NEAR(program.start.tip_m.x(), unit_m, 1e-15);
    ASSERT_EQ(program.assumed.size(), 1U);
    EXPECT_EQ(program.assumed[0].what, code);
  }
}

TEST(UnreadDialects, NumbersWithoutThePointOfTheOthersAreAssumedToBeMillimetres) {
  const auto assumed = [](const char* text) { return read_program_text(text, "part.ngc").assumed; };
  const std::vector<Assumption> mixed = assumed("G21 G90\nG0 X0 Y0 Z50.\nG1 Z-1.5 F300\nX80 F1200.\nY40.\n");
  ASSERT_EQ(mixed.size(), 1U);
  EXPECT_EQ(mixed[0].what, "X80 in line 4, without the point that other positions have");
  EXPECT_EQ(mixed[0].taken, "mm, where some controls count thousandths");
  EXPECT_TRUE(assumed("G21 G90\nG0 X0 Y0 Z50.\nG1 Z-1.5 F300\nX80. F1200\n").empty());
  EXPECT_TRUE(assumed("G21 G90\nG0 X10 Y0 Z5.5\nG1 Z-1 F300\n").empty()) << "no point ends a word";
}

}  // namespace unread_dialect_test
}  // namespace robomill::program
