#include "isochor/step/step_records.h"

#include <gtest/gtest.h>

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

#include "isochor/step/step_loader.h"
#include "temp_folder.h"

namespace isochor::internal {
namespace {

namespace fs = std::filesystem;

const std::string kHead =
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
    "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\n";
const std::string kTail = "ENDSEC;\nEND-ISO-10303-21;\n";

std::string with_data(const std::string& data) { return kHead + "DATA;\n" + data + kTail; }

// The records of the data as "ident|type|argument,argument"; lists are called $1, $2 and so on.
std::vector<std::string> layout(const std::string& data) {
  const std::string text = with_data(data);
  const auto records = scan_step(text, 0);
  if (!records) return {"declined"};
  const auto list = [](std::uint32_t number) { return "$" + std::to_string(number); };
  const auto word = [&](const TextSpan& span) {
    return text.substr(span.begin, span.end - span.begin);
  };
  std::vector<std::string> lines;
  for (size_t k = records->header; k < records->records.size(); ++k) {
    const StepRecord& record = records->records[k];
    std::string line =
        (record.list > 0 ? list(record.list) : word(record.ident)) + "|" + word(record.type) + "|";
    for (std::uint32_t a = 0; a < record.count; ++a) {
      const StepArgument& argument = records->arguments[record.first + a];
      line += (a > 0 ? "," : "") +
              (argument.kind == Part21Kind::kList ? list(argument.list) : word(argument.text));
    }
    lines.push_back(line);
  }
  return lines;
}

using Lines = std::vector<std::string>;

TEST(StepRecords, ListsComeBeforeTheRecordsAroundThemAndAreNumberedAsTheyOpen) {
  EXPECT_EQ(layout("#12=POINT('a',(1.,-2.5E-3),$,*);\n"),
            (Lines{"$1||1.,-2.5E-3", "#12|POINT|'a',$1,$,*"}));
  EXPECT_EQ(layout("#1 = NET((( #2 , #3 ) ,(#4)), .T. ) ;"),
            (Lines{"$2||#2,#3", "$3||#4", "$1||$2,$3", "#1|NET|$1,.T."}));
  EXPECT_EQ(layout("#1=M(LENGTH_MEASURE(1.),(),\"0F\");"),
            (Lines{"$1|LENGTH_MEASURE|1.", "$2||", "#1|M|$1,$2,\"0F\""}));
  EXPECT_EQ(layout("#1=E();"), (Lines{"#1|E|"}));
}

TEST(StepRecords, OnlyTheFirstPartOfAComplexEntityHasItsNumber) {
  EXPECT_EQ(layout("#7=(A((1,2)) B() /* between */ C('it''s (not; a list'));"),
            (Lines{"$1||1,2", "#7|A|$1", "|B|", "|C|'it''s (not; a list'"}));
}

TEST(StepRecords, WhatTheTwoScannersCouldReadDifferentlyIsDeclined) {
  const char* const odd[] = {
      "#1=A(1e5);",
      "#1=A(1E5);",
      "#1=A(.5);",
      "#1=A(1.5e3);",
      "#1=A(.t.);",
      "#1=A(.1.);",
      "#1=A(1 2);",
      "#1=A(1,);",
      "#1=A(,1);",
      "#1=A('a\x01');",
      "#1=A('\x80');",
      "#1=A(\"0g\");",
      "#1\n=A(1);",
      "#1/* */=A(1);",
      "#1=A(1)",
      "#1=A(1;",
      "#1=();",
      "#1=A;",
      "=A(1);",
      "#x=A(1);",
      "#12345678901=A(1);",
      "#1=&SCOPE;",
      "#1=A(1)/#2/;",
      "#1=A(ENDSCOPE(1));",
      "/* don't */ #1=A(1);",
      "/* open #1=A(1);",
      "/* ISO-1; */",
      "#1=A(1\f);",
      "#1=A(#);",
      "#1=A('open);",
      "#1=A(1.E);",
      "#1=A(-);",
      "/* ENDSTEP; */",
      "",
  };
  for (const std::string data : odd) EXPECT_EQ(layout(data), Lines{"declined"}) << data;
  EXPECT_EQ(layout("#1=A(" + std::string(100, '(') + std::string(100, ')') + ");"),
            Lines{"declined"});
}

TEST(StepRecords, FilesThatEndOrBeginOddlyAreDeclined) {
  const std::string whole = with_data("#1=A(1);");
  EXPECT_TRUE(scan_step(whole, 0));
  EXPECT_TRUE(scan_step("junk" + whole, 4));
  EXPECT_FALSE(scan_step("junk" + whole, 0));
  EXPECT_FALSE(scan_step(whole + "more", 0));
  EXPECT_FALSE(scan_step(kHead + "DATA('a',('b'));\n#1=A(1);" + kTail, 0));
  EXPECT_FALSE(scan_step(kHead + "ANCHOR;ENDSEC;DATA;\n#1=A(1);" + kTail, 0));
  EXPECT_FALSE(scan_step("ISO-10303-21;HEADER;ENDSEC;DATA;#1=A(1);" + kTail, 0));
  for (size_t size = 0; size + 2 < whole.size(); ++size) {
    EXPECT_FALSE(scan_step(whole.substr(0, size), 0)) << size;
  }
}

// Everything that the model holds: each entity as OpenCASCADE would write it, and its faults.
std::string contents(STEPControl_Reader& reader) {
  std::ostringstream out;
  const auto model = Handle(StepData_StepModel)::DownCast(reader.WS()->Model());
  StepData_StepWriter writer(model);
  writer.SendModel(Handle(StepData_Protocol)::DownCast(model->Protocol()));
  writer.Print(out);
  for (int k = 1; k <= model->NbEntities(); ++k) {
    out << model->IdentLabel(model->Value(k)) << (model->IsErrorEntity(k) ? " broken" : "")
        << (model->IsUnknownEntity(k) ? " unknown\n" : "\n");
  }
  return out.str();
}

void expect_same_model(const std::string& path) {
  SCOPED_TRACE(path);
  Message::DefaultMessenger()->ChangePrinters().Clear();
  const std::string text = file_bytes(path);
  const size_t start = text.find("ISO-10303-21");
  ASSERT_TRUE(scan_step(text, start)) << "is worth nothing when declined";
  STEPCAFControl_Reader theirs, ours;  // their constructors tell which entities there are
  std::istringstream in(text.substr(start));
  ASSERT_EQ(theirs.ChangeReader().ReadStream(path.c_str(), in), IFSelect_RetDone);
  ASSERT_EQ(load_step(ours.ChangeReader(), path, text, start), IFSelect_RetDone);
  const std::string expected = contents(theirs.ChangeReader());
  EXPECT_GT(expected.size(), 400u);
  EXPECT_TRUE(expected == contents(ours.ChangeReader()));
}

TEST(StepRecords, EveryKindOfArgumentBecomesTheSameModel) {
  const TempFolder folder;
  expect_same_model(folder.write(
      "kinds.step",
      with_data(
          "#0010=CARTESIAN_POINT('it''s \\X2\\00E9\\X0\\ and\n two lines',(+1.,-2.5E-03,7));\r\n"
          "/* Made by hand; no STEP tool */ #2 =\tDIRECTION ( '' , ( 0. , 0. , 1. ) ) ;\n"
          "#3=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
          "#4=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-05),#3,'','');\n"
          "#5=B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#0010,#2),(#99,#10)),.UNSPECIFIED.,.F.,.F.,.U.,("
          "2,2),"
          "(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.);\n"
          "#6=CARTESIAN_POINT($,(1.,2.));#6=CARTESIAN_POINT('twice',());\n"
          "#7=NO_SUCH_ENTITY((((1))),\"0F3\",$,*,.X_1.);#8=!MINE('');\n"
          "#9=VERTEX_POINT('',#6);#11=VERTEX_POINT('',(#6));\n")));
}

TEST(StepRecords, RealFilesBecomeTheSameModel) {
  std::set<fs::path> files;
  const auto add = [&](const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const auto suffix = entry.path().extension();
      if (suffix == ".stp" || suffix == ".step") files.insert(entry.path());
    }
  };
  add(fs::path(ISOCHOR_SOURCE_DIR) / "data" / "step");
  EXPECT_GE(files.size(), 5u);
  if (const char* more = std::getenv("ISOCHOR_EXTRA_DATA")) add(more);
  for (const fs::path& file : files) expect_same_model(file.string());
}

TEST(StepRecords, TheirScannerReadsWhatOursDeclines) {
  const TempFolder folder;
  const std::string text = with_data("#1=CARTESIAN_POINT('',(.5,1.,2.));\n");
  const std::string path = folder.write("odd.step", text);
  ASSERT_FALSE(scan_step(text, 0));
  STEPCAFControl_Reader reader;
  ASSERT_EQ(load_step(reader.ChangeReader(), path, text, 0), IFSelect_RetDone);
  EXPECT_NE(contents(reader.ChangeReader()).find("0.5"), std::string::npos);
}

}  // namespace
}  // namespace isochor::internal
